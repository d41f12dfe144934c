"""A benchmark's folder as a page for readers: tables and pictures beside the paper's numbers."""
