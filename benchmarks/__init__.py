"""Speed, memory and quality, measured side by side with others in the same run."""
