"""Non-circular pulleys and cams: a spring that can be bought balances a joint exactly."""
