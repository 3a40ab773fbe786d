"""Who may do what: roles by token, one operator lease, rates of commands."""
