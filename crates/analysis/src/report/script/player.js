// The playback of a conflict in its card: a canvas, a slider, Play and Slow, and the curves. It begins as a still of the worst step.

/** Slow is this part of real time. */
const SLOW = 0.25;
/** How long it halts at the worst step, in s. */
const HALT = 1;
/** For readers that prefer no motion: one still after the other, this far apart, in s. */
const STILL = 0.5;
/** Room around the two, and the least size of what is shown, in m. */
const AROUND = 7;
const LEAST_SHOWN = 32;
/** The two are in view from this long before the worst step until as long after it, in s. */
const IN_VIEW = 2;

class Player {
  constructor(row) {
    this.row = row;
    this.clip = clipOf(row);
    const { times, worst } = this.clip;
    this.worst = times[worst];
    this.time = this.worst;
    this.isSlow = false;
    this.canvas = make("canvas");
    this.picture = make("div", { className: "chart" }, this.canvas);
    this.picture.setAttribute("role", "img");
    describeChart(this.picture, `The conflict from ${number(this.worst - times[0], 1)} s before its worst step to ${number(times[times.length - 1] - this.worst, 1)} s after it, from above`);
    this.play = make("button", { type: "button", textContent: "Play" });
    this.slow = make("button", { type: "button", textContent: "Slow" });
    this.slow.setAttribute("aria-pressed", "false");
    this.slider = make("input", { type: "range", min: 0, max: times.length - 1, step: 1, value: worst });
    this.slider.setAttribute("aria-label", "Time before and after the worst step");
    this.label = make("output");
    this.curves = drawCurves(row, this.clip);
    this.element = make("div", { className: "player" }, this.picture,
      make("div", { className: "play" }, this.play, this.slider, this.label, this.slow), this.curves.svg);
    this.play.onclick = () => this.toggle();
    this.picture.onclick = () => this.toggle();
    this.slow.onclick = () => {
      this.isSlow = !this.isSlow;
      this.slow.setAttribute("aria-pressed", this.isSlow);
    };
    this.slider.oninput = () => this.go(times[this.slider.value]);
    this.curves.svg.onpointerdown = (event) => this.go(this.curves.timeAt(event));
    this.curves.svg.onpointermove = (event) => event.buttons && this.go(this.curves.timeAt(event));
    this.element.onkeydown = (event) => this.press(event);
  }

  /** Draws once it is in the page. */
  start() {
    this.watch = new ResizeObserver(() => this.fit());
    this.watch.observe(this.picture);
    this.fit();
  }

  dispose() {
    this.stop();
    this.watch.disconnect();
  }

  /** The part of the world that is shown, and its roads. */
  fit() {
    const [width, height] = [this.picture.clientWidth, this.picture.clientHeight];
    if (!width || (this.view && this.view.width === width && this.view.height === height)) return;
    const { clip, row } = this;
    const points = [[column.x[row], column.y[row]]];
    clip.times.forEach((time, place) => {
      if (Math.abs(time - this.worst) > IN_VIEW) return;
      for (const { x, y } of clip.users.slice(0, 2)) if (x && x[place] !== null) points.push([x[place], y[place]]);
    });
    const [low, high] = [Math.min, Math.max].map((end) => [0, 1].map((axis) => end(...points.map((point) => point[axis]))));
    const [across, up] = [0, 1].map((axis) => Math.max(high[axis] - low[axis] + 2 * AROUND, LEAST_SHOWN));
    const scale = Math.min(width / across, height / up);
    const corner = (axis, pixels) => (low[axis] + high[axis]) / 2 - pixels / scale / 2;
    this.view = { x: 0, y: 0, width, height, scale, left: corner(0, width), bottom: corner(1, height) };
    const sharp = window.devicePixelRatio || 1;
    for (const canvas of [this.canvas, this.ground = make("canvas")]) {
      Object.assign(canvas, { width: Math.round(width * sharp), height: Math.round(height * sharp) });
      canvas.getContext("2d").scale(sharp, sharp);
    }
    const context = this.ground.getContext("2d");
    context.fillStyle = colours.ground;
    context.fillRect(0, 0, width, height);
    paintRoads(context, this.view);
    this.draw();
  }

  toggle() {
    if (this.isPlaying) this.stop();
    else this.begin();
  }

  begin() {
    const { times } = this.clip;
    Player.playing?.stop();
    Player.playing = this;
    this.isPlaying = true;
    this.play.textContent = "Pause";
    // The still is the worst step: playing from there would not show how it came about.
    if (this.time === this.worst || this.time >= times[times.length - 1]) this.time = times[0];
    let [last, wait] = [performance.now(), 0];
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches ? STILL : 0;
    const step = (now) => {
      if (!this.isPlaying) return;
      const passed = ((now - last) / 1000) * (this.isSlow ? SLOW : 1);
      if (wait > 0) {
        wait -= (now - last) / 1000;
        last = now;
      } else if (passed >= still) {
        last = now;
        const before = this.time;
        this.time = Math.min(before + passed, times[times.length - 1]);
        if (before < this.worst && this.time >= this.worst) [this.time, wait] = [this.worst, HALT];
        this.draw();
      }
      if (this.time >= times[times.length - 1]) this.stop();
      else this.frame = requestAnimationFrame(step);
    };
    this.frame = requestAnimationFrame(step);
  }

  stop() {
    cancelAnimationFrame(this.frame);
    this.isPlaying = false;
    this.play.textContent = "Play";
    if (Player.playing === this) Player.playing = null;
  }

  /** Shows a time, and does not play on. */
  go(time) {
    this.stop();
    this.time = time;
    this.draw();
  }

  press(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    // Buttons know the space bar, the slider the arrows.
    if (event.key === " " && event.target.tagName !== "BUTTON") this.toggle();
    else if (step && event.target !== this.slider) this.go(this.clip.times[Math.min(Math.max(placeAt(this.clip, this.time) + step, 0), this.clip.times.length - 1)]);
    else return;
    event.preventDefault();
  }

  draw() {
    const { clip, time, view, row } = this;
    if (!view) return;
    const context = this.canvas.getContext("2d");
    const place = placeAt(clip, time);
    const on = ([x, y]) => [(x - view.left) * view.scale, view.height - (y - view.bottom) * view.scale];
    const polygon = (points, fill, stroke) => {
      context.beginPath();
      points.map(on).forEach(([x, y]) => context.lineTo(x, y));
      context.closePath();
      context.fillStyle = fill;
      context.fill();
      if (stroke) Object.assign(context, { strokeStyle: stroke, lineWidth: 1 }), context.stroke();
    };
    context.drawImage(this.ground, 0, 0, view.width, view.height);
    for (const { corners, changes } of clip.signals) {
      const [, colour] = changes.findLast(([from]) => from <= place);
      polygon(pairs(corners), colour);
    }
    // Both have the colour of the worst severity so far, as in sumo-gui and in a clip: a ring tells the ego from the foe.
    const danger = clip.severity[place] >= 0 ? severityColour(clip.severity[place]) : null;
    if (danger && drawn.has(row)) {
      for (const snapshot of [1, 2]) {
        const { line, width } = figure(drawn.get(row)[snapshot]);
        if (line.length < 2) continue;
        context.beginPath();
        line.map(on).forEach(([x, y]) => context.lineTo(x, y));
        Object.assign(context, { strokeStyle: danger, globalAlpha: 0.22, lineWidth: width * view.scale, lineJoin: "round" });
        context.stroke();
        context.globalAlpha = 1;
      }
    }
    // The two above the others, the smaller one on top.
    const labels = [];
    const area = (number_of) => clip.users[number_of].length * clip.users[number_of].width || 0;
    const order = [...clip.users.keys()].slice(2).concat(area(0) < area(1) ? [1, 0] : [0, 1]);
    order.forEach((number_of) => {
      const user = clip.users[number_of];
      if (user.outlines) {
        user.outlines.forEach((outline) => polygon(pairs(outline), (number_of < 2 && danger) || colours.faint, colours.ink));
        return;
      }
      const pose = poseAt(clip, user, place, time);
      if (!pose) return;
      const shape = figure([...pose, user.length, user.width]);
      const isOfPair = number_of < 2;
      const fill = (isOfPair && danger) || colours.card;
      if (user.category === "person") {
        const [x, y] = on(pose);
        context.beginPath();
        context.arc(x, y, Math.max(0.4 * view.scale, 4), 0, 2 * Math.PI);
        Object.assign(context, { fillStyle: fill, strokeStyle: colours.ink, lineWidth: 1 });
        context.fill();
        context.stroke();
      } else {
        polygon(shape.corners, fill, colours.ink);
        polygon(shape.nose, isOfPair && danger ? colours.card : colours.faint);
      }
      if (!isOfPair) return;
      const around = user.category === "person" ? circleAround(on(pose), Math.max(0.4 * view.scale, 4)) : shape.corners.map(on);
      const ring = ringOf(around, number_of === 0);
      context.beginPath();
      ring.points.forEach(([x, y]) => context.lineTo(x, y));
      context.closePath();
      Object.assign(context, { strokeStyle: colours.ink, lineWidth: ring.lineWidth });
      context.setLineDash(ring.lineDash);
      context.stroke();
      context.setLineDash([]);
      labels.push([["ego", "foe"][number_of], on(pose)]);
    });
    if (clip.severity[place] >= 0) {
      const [x, y] = on([column.x[row], column.y[row]]);
      context.beginPath();
      context.arc(x, y, 6, 0, 2 * Math.PI);
      Object.assign(context, { strokeStyle: colours.meeting, lineWidth: 2.5 });
      context.stroke();
    }
    Object.assign(context, { font: `600 12px ${FONT}`, textAlign: "center", strokeStyle: colours.ground, lineWidth: 3, lineJoin: "round" });
    // The upper label above its front, the other one below it.
    labels.sort((a, b) => a[1][1] - b[1][1]).forEach(([text, [x, y]], below) => {
      context.fillStyle = colours.ink;
      context.strokeText(text, x, below ? y + 20 : y - 12);
      context.fillText(text, x, below ? y + 20 : y - 12);
    });
    this.say(place);
  }

  /** Where in time it is. */
  say(place) {
    const apart = this.time - this.worst;
    const isWorst = Math.abs(apart) < 0.005;
    this.label.textContent = isWorst ? "worst step" : `${signed(apart, 1)} s`;
    this.slider.value = place;
    this.slider.setAttribute("aria-valuetext", isWorst ? "the worst step" : `${number(Math.abs(apart), 1)} s ${apart < 0 ? "before" : "after"} the worst step`);
    this.curves.cursor(this.time);
  }
}
Player.playing = null;

/** The corners of a polygon that looks like a circle. */
const circleAround = ([x, y], radius) => Array.from({ length: 16 }, (_, corner) =>
  [x + radius * Math.cos((corner * Math.PI) / 8), y + radius * Math.sin((corner * Math.PI) / 8)]);

/** Numbers two by two. */
const pairs = (numbers) => Array.from({ length: numbers.length / 2 }, (_, place) => [numbers[2 * place], numbers[2 * place + 1]]);
