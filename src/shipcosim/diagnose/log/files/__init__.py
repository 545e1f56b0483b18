"""Files of logs as they come: text of any dialect, Excel, messages; times and positions as people write them."""
