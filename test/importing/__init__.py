# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
