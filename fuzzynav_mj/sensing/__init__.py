"""From range readings to perceived obstacles."""
