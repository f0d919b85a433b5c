"""Springs of a list, chosen with their attachments."""
