"""Roll-pitch shoulders with a bevel differential (Cho, Lee, Lee and Kang 2012)."""
