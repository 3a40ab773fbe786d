"""From depth frames to robot commands: perception, intent and safety. Knows no socket and no web server."""
