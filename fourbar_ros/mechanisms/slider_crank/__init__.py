"""The offset slider-crank."""
