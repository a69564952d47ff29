// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// A slider: its user's from the first move until the server has answered the last. See owned.py.
export default {
  template: `
    <q-slider ref="qRef" :model-value="isOwned ? moved : value"
              @update:model-value="move" @pan="hold"><slot /></q-slider>`,
  props: { value: Number, answered: Number },
  emits: ["commit"],
  data() {
    return { moved: this.value, isHeld: false, asked: this.answered };
  },
  computed: {
    isOwned() {
      return this.isHeld || this.asked !== this.answered;
    },
  },
  methods: {
    hold(phase) {
      if (!this.isOwned) this.moved = this.value;
      this.isHeld = phase === "start";
    },
    move(value) {
      this.moved = value;
      this.asked += 1;
      this.$emit("commit", [value, this.asked]);
    },
  },
};
