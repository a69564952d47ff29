"""All extrema of any quantity over the input, with proofs on demand."""
