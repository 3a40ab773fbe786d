"""The operator's side of the assisted pick: choosing a fruit, confirming, keeping the hands closed, taking over."""
