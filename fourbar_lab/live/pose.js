// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// Something drawn of a pose: while the picture moves (player.js), of its frame, else as the server drew it.
export default {
  template: `<component :is="tag" v-html="under + (frames[frame] ?? still)"></component>`,
  props: { tag: String, under: String, still: String, frames: Array },
  data() {
    return { frame: -1 };
  },
  mounted() {
    window.addEventListener("fb-frame", this.follow);
  },
  unmounted() {
    window.removeEventListener("fb-frame", this.follow);
  },
  methods: {
    follow(event) {
      this.frame = event.detail;
    },
  },
};
