"""The users of a pendant: their roles, passwords, sessions, and the audit trail of their actions."""
