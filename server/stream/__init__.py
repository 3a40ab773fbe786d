"""What goes to the clients: one outbox per client, one hub for all."""
