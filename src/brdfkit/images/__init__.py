"""Pictures as arrays: errors between pictures, tone mapping, and small pictures of materials."""
