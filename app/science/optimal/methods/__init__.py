"""All methods of appendix B by name, answering the same problems side by side."""
