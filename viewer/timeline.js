// Play, step, and a track that shows when which camera is off and when feet are on the floor.
import {offColour, SIDE_COLOURS} from './colours.js';

const THUMB_PX = 16;
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];

export class Timeline {
  constructor(state, actions) {
    this.state = state;
    this.actions = actions;
    const find = id => document.getElementById(id);
    this.play = find('play');
    this.clock = find('clock');
    this.seconds = find('seconds');
    this.number = find('number');
    this.slider = find('slider');
    this.strips = find('strips');
    this.names = find('strip-names');
    this.speed = find('speed');
    SPEEDS.forEach(speed => this.speed.add(new Option(`${speed}×`, speed, false, speed === state.speed)));
    this.play.onclick = () => actions.togglePlay();
    find('back').onclick = () => actions.step(-1);
    find('forward').onclick = () => actions.step(1);
    this.slider.oninput = () => actions.seek(Number(this.slider.value));
    this.speed.onchange = () => actions.setSpeed(Number(this.speed.value));
    this.strips.onpointerdown = event => {
      this.strips.setPointerCapture(event.pointerId);
      const seek = e => {
        const box = this.strips.getBoundingClientRect();
        actions.seek(Math.round((e.clientX - box.left - THUMB_PX / 2) / (box.width - THUMB_PX) * (this.model.frames - 1)));
      };
      seek(event);
      this.strips.onpointermove = seek;
    };
    this.strips.onpointerup = this.strips.onpointercancel = () => { this.strips.onpointermove = null; };
    new ResizeObserver(() => this.drawStrips()).observe(this.strips);
  }

  setModels(models) {
    this.models = models;
    this.slider.max = this.model.frames - 1;
    this.drawStrips();
  }

  get model() { return this.models[this.state.active]; }

  drawStrips() {
    if (!this.models) return;
    const cameras = this.model.cameras.filter(camera => camera.used && Number.isFinite(camera.medianPx));
    const contacts = this.model.people.flatMap(person => person.contacts);
    const rows = cameras.length + (contacts.length > 0 ? 1 : 0);
    this.strips.hidden = rows === 0;
    if (rows === 0) return;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const rowHeight = rows > 6 ? 5 : 9;
    const row = rowHeight + 2;
    this.strips.style.height = `${rows * row - 2}px`;
    const width = this.strips.width = Math.round(this.strips.clientWidth * ratio);
    this.strips.height = Math.round((rows * row - 2) * ratio);
    const context = this.strips.getContext('2d');
    // The thumb of the slider is this far from the ends of its track.
    const margin = THUMB_PX / 2 * ratio;
    const x = frame => margin + frame / Math.max(this.model.frames - 1, 1) * (width - 2 * margin);
    cameras.forEach((camera, r) => this.drawCamera(context, camera, r * row * ratio, rowHeight * ratio, margin, width));
    const top = cameras.length * row * ratio;
    const half = Math.floor(rowHeight * ratio / 2);
    for (const {left, first, last} of contacts) {
      context.fillStyle = SIDE_COLOURS[left ? 'l' : 'r'];
      context.fillRect(x(first), top + (left ? 0 : half), Math.max(1, x(last) - x(first)), half - 1);
    }
    this.names.replaceChildren(...(rows > 6 ? [] : [...cameras.map(c => c.name), ...(contacts.length > 0 ? ['feet'] : [])].map(name => {
      const label = document.createElement('span');
      label.textContent = name;
      label.style.height = `${row}px`;
      return label;
    })));
    this.strips.title = `How far each camera's keypoints are from the solution: ${cameras.map(c => c.name).join(', ')}` +
        (contacts.length > 0 ? '; below: left and right foot on the floor' : '');
  }

  /** The mean difference of the frames that a column of pixels stands for. */
  drawCamera(context, camera, top, height, margin, width) {
    const frames = this.model.frames;
    const perPixel = frames / (width - 2 * margin);
    // Severity speaks of percent of the body; here pixels are turned into it by the camera's medians.
    const percentPerPx = camera.medianPercent / camera.medianPx;
    for (let x = margin; x < width - margin; ++x) {
      let sum = 0;
      let count = 0;
      const first = Math.floor((x - margin) * perPixel);
      for (let t = first; t < Math.min(Math.max((x - margin + 1) * perPixel, first + 1), frames); ++t) {
        const px = camera.differenceByFrame[t];
        if (px !== px) continue;
        sum += this.model.severity(px * percentPerPx);
        ++count;
      }
      if (count === 0) continue;
      context.fillStyle = offColour(sum / count, '--strip');
      context.fillRect(x, top, 1, height);
    }
  }

  draw() {
    this.slider.value = this.state.frame;
    const time = this.model.time(Math.min(this.state.frame, this.model.frames - 1));
    const last = this.model.frames - 1;
    this.seconds.textContent = time === null ? '' : `${time.toFixed(2)} s · `;
    this.number.textContent = `${this.state.frame} of ${last}`;
    this.slider.setAttribute('aria-valuetext', this.clock.textContent);
    document.body.classList.toggle('is-playing', this.state.isPlaying);
    this.play.title = this.state.isPlaying ? 'Pause (space)' : 'Play (space)';
    this.play.setAttribute('aria-label', this.state.isPlaying ? 'Pause' : 'Play');
    this.speed.value = String(this.state.speed);
  }
}
