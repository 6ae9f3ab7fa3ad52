"""Reading outlines, readings and covariates; nothing is mended by guessing or dropped unsaid."""
