"""How a spring on paper is built, and what that leaves."""
