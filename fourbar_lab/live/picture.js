// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// An SVG picture. What has the class "grip" in it can be dragged, with a mouse or a finger, and
// its place on the picture is told; a finger beside it scrolls the page.
export default {
  template: `
    <svg :viewBox="'0 0 ' + size.join(' ')" :class="{ 'fb-held': pointer !== null }"
         @touchstart="hold" @pointerdown="take" @pointermove="move" @pointerup="leave" @lostpointercapture="leave">
      <g v-html="under"></g><g v-html="content"></g>
    </svg>`,
  props: { size: Array, under: String, content: String },
  emits: ["take", "move", "leave"],
  data() {
    return { pointer: null, last: null };
  },
  methods: {
    place(event) {
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(
        this.$el.getScreenCTM().inverse());
      return [at.x, at.y];
    },
    hold(event) {
      // the grip is drawn anew while the finger moves: its touch-action alone would not last
      if (event.target.closest(".grip")) event.preventDefault();
    },
    take(event) {
      if (event.button !== 0 || this.pointer !== null || !event.target.closest(".grip")) return;
      event.preventDefault();
      this.pointer = event.pointerId;
      this.$el.setPointerCapture(event.pointerId); // the grip itself is drawn anew as it moves
      this.$emit("take", this.place(event));
    },
    move(event) {
      if (event.pointerId !== this.pointer) return;
      if (!this.last) requestAnimationFrame(this.tell);
      this.last = this.place(event);
    },
    tell() {
      if (this.last) this.$emit("move", this.last);
      this.last = null;
    },
    leave(event) {
      if (event.pointerId !== this.pointer) return;
      this.tell();
      this.pointer = null;
      this.$emit("leave");
    },
  },
};
