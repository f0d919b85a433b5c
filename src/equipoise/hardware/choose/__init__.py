"""Springs that exist and their attachments, chosen together."""
