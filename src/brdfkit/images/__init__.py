"""Pictures in memory: errors between them, tone mapping, and small pictures of materials."""
