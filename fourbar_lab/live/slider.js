// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// A slider: its user's from the first move until the server has answered the last. See controls.py.
export default {
  template: `
    <q-slider ref="qRef" :min="min" :max="max" :model-value="isOwned ? moved : value"
              @keydown.home.prevent="move(min)" @keydown.end.prevent="move(max)"
              @update:model-value="move" @pan="hold"><slot /></q-slider>`,
  props: { value: Number, answered: Number, min: Number, max: Number },
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
