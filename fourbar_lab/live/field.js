// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// A number to type: its user's from the focus or the first key until the server has answered.
// See controls.py. Not of type number: browsers drop what they do not understand of such a field.
export default {
  template: `
    <q-input ref="qRef" :model-value="isOwned ? typed : value" @update:model-value="type"
             autocomplete="off" spellcheck="false"
             @focus="take" @blur="leave" @keydown.enter="commit"><slot /></q-input>`,
  props: { value: String, answered: Number },
  emits: ["commit"],
  data() {
    return { typed: this.value, taken: this.value, isTyping: false, asked: this.answered };
  },
  computed: {
    isOwned() {
      return this.isTyping || this.asked !== this.answered;
    },
  },
  methods: {
    take() {
      if (!this.isOwned) this.typed = this.taken = this.value;
      this.isTyping = true;
    },
    type(text) {
      if (!this.isTyping) this.take();
      this.typed = text;
    },
    leave() {
      if (this.isTyping && this.typed !== this.taken) this.commit();
      this.isTyping = false;
    },
    commit() {
      if (!this.isTyping) return;
      this.isTyping = false;
      this.asked += 1;
      this.$emit("commit", [this.typed, this.asked]);
    },
  },
};
