"""Access to the folder of the user's project: its files, the trash for deleted files, and the changes
since the last git commit.
"""
