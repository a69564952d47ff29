# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""All extrema of any quantity over the input, with proofs on demand."""
