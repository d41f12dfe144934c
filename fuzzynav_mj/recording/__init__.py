"""What a recording shows, as plain arrays; `fuzzynav_mj.rerun_log` writes them."""
