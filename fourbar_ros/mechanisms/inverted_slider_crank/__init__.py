"""The inverted slider-crank."""
