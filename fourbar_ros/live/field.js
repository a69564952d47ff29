// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// A number to type: its user's from the focus until the server has answered. See owned.py.
export default {
  template: `
    <q-input ref="qRef" type="number" :model-value="isOwned ? typed : value"
             @update:model-value="text => typed = text"
             @focus="take" @blur="isFocused = false" @change="commit"><slot /></q-input>`,
  props: { value: String, answered: Number },
  emits: ["commit"],
  data() {
    return { typed: this.value, isFocused: false, asked: this.answered };
  },
  computed: {
    isOwned() {
      return this.isFocused || this.asked !== this.answered;
    },
  },
  methods: {
    take() {
      if (!this.isOwned) this.typed = this.value;
      this.isFocused = true;
    },
    commit(text) {
      this.typed = text;
      this.asked += 1;
      this.$emit("commit", [text, this.asked]);
    },
  },
};
