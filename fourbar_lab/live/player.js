// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// The picture, and what moves it: it plays, scrubs and drags through the frames of a cycle. Where
// it comes to rest it tells the input, and the server draws that pose. Other elements that show a
// pose (pose.js) follow the number of the frame, or show what the server drew (-1).
export default {
  template: `
    <div>
      <svg :viewBox="'0 0 ' + size.join(' ')" :class="{ 'fb-held': pointer !== null, 'fb-ready': inputs.length }" class="fb-picture"
           role="img" aria-label="the mechanism in its pose" @touchstart="hold" @pointerdown="take"
           @pointermove="move" @pointerup="leave" @lostpointercapture="leave">
        <g v-html="under"></g><g v-html="picture"></g>
      </svg>
      <div class="fb-transport">
        <q-btn round dense color="primary" :icon="isPlaying ? 'pause' : 'play_arrow'" aria-label="play or pause" @click="play"></q-btn>
        <q-slider class="col" aria-label="input" :min="bounds[0]" :max="bounds[1]" :step="(bounds[1] - bounds[0]) / 720"
                  :model-value="input" @update:model-value="scrub" @change="rest"
                  @keydown.home.prevent="rest(bounds[0])" @keydown.end.prevent="rest(bounds[1])"></q-slider>
        <q-input dense class="fb-number" aria-label="input value" :label="label" :model-value="typed"
                 @update:model-value="(text) => { typed = text; isTyping = true; }" @focus="isTyping = true"
                 @keydown.enter="type" @blur="type(); isTyping = false"></q-input>
        <span>seconds a cycle</span>
        <q-slider v-model="pace" :min="1" :max="30" :step="0.5" label aria-label="seconds a cycle" style="width: 6rem"></q-slider>
      </div>
    </div>`,
  props: {
    size: Array, under: String, still: String, label: String, bounds: Array, at: Number, answered: Number,
    // inputs and pictures of each frame, places of the joints in it, first and last frame of each range
    inputs: Array, frames: Array, joints: Array, ranges: Array, turns: Number,
  },
  emits: ["rest"],
  data() {
    return { frame: -1, scrubbed: this.at, typed: this.shown(this.at), isTyping: false, asked: this.answered,
             isPlaying: false, pace: 6, phase: 0, way: 1, last: 0, pointer: null, joint: 0 };
  },
  computed: {
    isMoving() {
      return this.isPlaying || this.pointer !== null || this.asked !== this.answered;
    },
    input() {
      return this.isMoving ? this.scrubbed : this.at;
    },
    picture() {
      return (this.isMoving && this.frames[this.frame]) || this.still;
    },
  },
  watch: {
    input(value) {
      if (!this.isTyping) this.typed = this.shown(value);
    },
    answered() {
      if (!this.isTyping) this.typed = this.shown(this.input);
    },
    isMoving(value) {
      if (!value) this.tell(-1);
    },
    still() {
      if (!this.still) this.isPlaying = false;
    },
    frames() {
      this.phase = this.nearest(this.scrubbed);
      if (this.isMoving) this.tell(this.phase);
    },
  },
  methods: {
    shown(value) {
      return String(parseFloat(value.toPrecision(6)));
    },
    tell(frame) {
      this.frame = frame;
      window.dispatchEvent(new CustomEvent("fb-frame", { detail: frame }));
    },
    nearest(input) {
      let best = 0;
      this.inputs.forEach((x, k) => {
        if (Math.abs(x - input) < Math.abs(this.inputs[best] - input)) best = k;
      });
      return best;
    },
    goTo(frame) {
      this.scrubbed = this.inputs[frame];
      this.tell(frame);
    },
    rest(input) {
      this.scrubbed = input;
      this.asked += 1;
      this.$emit("rest", [input, this.asked]);
    },
    scrub(input) {
      this.isPlaying = false;
      if (this.asked === this.answered) this.asked += 1; // until the server has drawn where it rests
      this.scrubbed = input;
      if (this.inputs.length) this.tell(this.nearest(input));
    },
    type() {
      if (!this.isTyping || this.typed === this.shown(this.input)) return;
      this.isTyping = false;
      if (!this.typed.trim()) return (this.typed = this.shown(this.input));
      this.isPlaying = false;
      this.asked += 1;
      this.$emit("rest", [this.typed, this.asked]); // the server reads its unit
    },
    play() {
      this.isPlaying = !this.isPlaying && Boolean(this.still);
      if (!this.isPlaying) return this.rest(this.scrubbed);
      this.scrubbed = this.at;
      this.phase = this.nearest(this.at);
      this.last = performance.now();
      requestAnimationFrame(this.advance);
    },
    advance(now) {
      if (!this.isPlaying) return;
      const seconds = Math.min((now - this.last) / 1000, 0.2);
      this.last = now;
      const range = this.ranges.find(([low, high]) => low - 0.5 <= this.phase && this.phase <= high + 0.5);
      if (range) {
        const [low, high] = range;
        if (this.turns) {
          const steps = (this.turns * seconds * (high - low)) / this.pace;
          this.phase = low + ((this.phase + steps - low + high - low) % (high - low));
        } else {
          this.phase += (2 * this.way * seconds * (high - low)) / this.pace;
          if (this.phase < low || this.phase > high) {
            this.phase = Math.min(Math.max(this.phase, low), high);
            this.way = -this.way;
          }
        }
        this.goTo(Math.round(this.phase));
      }
      requestAnimationFrame(this.advance);
    },
    place(event) {
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(
        event.currentTarget.getScreenCTM().inverse());
      return [at.x, at.y];
    },
    hold(event) {
      // the grip is drawn anew while the finger moves: its touch-action alone would not last
      if (event.target.closest(".grip")) event.preventDefault();
    },
    take(event) {
      const grip = event.target.closest(".grip");
      if (event.button !== 0 || this.pointer !== null || !grip || !this.inputs.length) return;
      event.preventDefault();
      this.joint = [...event.currentTarget.querySelectorAll(".grip")].indexOf(grip);
      this.isPlaying = false;
      this.scrubbed = this.at;
      this.pointer = event.pointerId;
      event.currentTarget.setPointerCapture(event.pointerId); // the grip itself is drawn anew as it moves
    },
    move(event) {
      if (event.pointerId !== this.pointer) return;
      // paths cross themselves: a whole cycle away counts as 20 px more
      const [x, y] = this.place(event), span = this.bounds[1] - this.bounds[0];
      let best = 0, least = Infinity;
      this.joints.forEach((places, k) => {
        let away = Math.abs(this.inputs[k] - this.scrubbed);
        if (this.turns) away = Math.min(away, span - away);
        const jump = away > span / 8 ? (20 * away) / span : 0;
        const far = Math.hypot(places[this.joint][0] - x, places[this.joint][1] - y) + jump;
        if (far < least) [best, least] = [k, far];
      });
      this.goTo(best);
    },
    leave(event) {
      if (event.pointerId !== this.pointer) return;
      if (event.type === "pointerup") this.move(event); // its last move may not have come
      this.pointer = null;
      this.rest(this.scrubbed);
    },
  },
};
