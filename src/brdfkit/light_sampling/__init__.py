"""What emitter plugins compute from a picture of the surroundings, without Mitsuba."""
