"""Open hand or fist, from colour and depth round the tracked hand."""
