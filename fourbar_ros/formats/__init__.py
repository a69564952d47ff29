# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
File formats of bags: MCAP, CDR, message definitions, rosbag2's folder.

``mcap_records`` (a record), ``mcap_writer`` and ``mcap_scan`` (a file), ``definitions`` and
``cdr`` (a message), ``rosbag2`` and ``file_metadata`` (what rosbag2 keeps around the messages).
Nothing here knows a mechanism or a scene.
"""
