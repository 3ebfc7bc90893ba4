"""The people of a pendant: their roles, passwords, sessions, and the audit trail of what they did."""
