"""The edge: settings, sessions, HTTP, websocket, command line. The only package that knows sockets."""
