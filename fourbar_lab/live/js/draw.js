// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// Drawing with the mouse: tools that change the scene.
export function addDrawing(page) {
  page.tools.pose.hint ??= "";
}
