// Angles over time, left and right in one plot, with a cursor at the frame shown.
import {SIDE_COLOURS, themeColour} from './colours.js';
import {note} from './views.js';

const SPANS = [['all', 0], ['10 s', 10], ['3 s', 3]];

/** "knee_flexion_l" -> ["knee flexion", "l"]. */
function splitName(name) {
  const match = /^(.*)_([lr])$/.exec(name);
  return match ? [match[1].replaceAll('_', ' '), match[2]] : [name.replaceAll('_', ' '), 'm'];
}

export class Plots {
  constructor(parent, state, data, actions) {
    this.parent = parent;
    this.state = state;
    this.data = data;
    this.actions = actions;
    this.span = 0;
    this.person = 0;
  }

  setModels(models) {
    if (models !== this.models) {
      // Steps are not to be seen in a minute of them.
      const {frames, fps} = models[0];
      this.span = fps > 0 && frames > 30 * fps ? 10 : 0;
    }
    this.models = models;
    this.build();
  }

  get model() { return this.models[this.state.active]; }

  build() {
    this.parent.textContent = '';
    this.plots = [];
    this.drawnFrom = null;
    const people = this.model.people.filter(person => person.series.length > 0);
    if (people.length === 0) {
      this.parent.append(note('This page has no joint angles.'));
      return;
    }
    const person = people.find(p => p.index === this.person) || people[0];
    this.person = person.index;
    const bar = document.createElement('div');
    bar.className = 'bar';
    if (people.length > 1) bar.append(this.makePersonChoice(people));
    if (this.model.fps > 0) bar.append(this.makeSpanChoice());
    this.parent.append(bar);
    const byName = new Map();
    for (const series of person.series) {
      const [name, side] = splitName(series.name);
      if (!byName.has(name)) byName.set(name, {name, unit: series.unit, lines: []});
      byName.get(name).lines.push({side, values: this.data.array(series.values)});
    }
    for (const plot of byName.values()) {
      plot.lines.sort((a, b) => a.side.localeCompare(b.side));
      this.plots.push(this.makePlot(plot));
    }
    this.observer = new ResizeObserver(() => this.drawCurves());
    this.observer.observe(this.parent);
  }

  makePersonChoice(people) {
    const select = document.createElement('select');
    select.setAttribute('aria-label', 'Whose angles');
    people.forEach(person => select.add(new Option(person.name, person.index, false, person.index === this.person)));
    select.onchange = () => {
      this.person = Number(select.value);
      this.build();
      this.drawCurves();
    };
    return select;
  }

  makeSpanChoice() {
    const choice = document.createElement('div');
    choice.className = 'segments';
    for (const [label, seconds] of SPANS) {
      const button = document.createElement('button');
      button.textContent = label;
      button.setAttribute('aria-pressed', seconds === this.span);
      button.onclick = () => {
        this.span = seconds;
        for (const other of choice.children) other.setAttribute('aria-pressed', other === button);
        this.drawCurves();
      };
      choice.append(button);
    }
    return choice;
  }

  makePlot(plot) {
    const figure = document.createElement('figure');
    figure.className = 'plot';
    const caption = document.createElement('figcaption');
    const name = document.createElement('b');
    name.textContent = plot.name;
    const now = document.createElement('span');
    now.className = 'now';
    caption.append(name, now);
    const area = document.createElement('div');
    area.className = 'area';
    const canvas = document.createElement('canvas');
    const cursor = document.createElement('i');
    cursor.className = 'cursor';
    area.append(canvas, cursor);
    figure.append(caption, area);
    this.parent.append(figure);
    const seek = event => {
      const box = canvas.getBoundingClientRect();
      const [first, last] = this.window();
      this.actions.seek(Math.round(first + (event.clientX - box.left) / box.width * (last - first)));
    };
    area.onpointerdown = event => {
      area.setPointerCapture(event.pointerId);
      seek(event);
      area.onpointermove = seek;
    };
    area.onpointerup = area.onpointercancel = () => { area.onpointermove = null; };
    let [low, high] = [Infinity, -Infinity];
    for (const {values} of plot.lines) {
      for (const value of values) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    if (!(low <= high)) [low, high] = [0, 1];
    const room = Math.max(0.06 * (high - low), 1);
    return {...plot, low: low - room, high: high + room, canvas, cursor, now};
  }

  /** First and last frame in view: the page of this length that the frame is on. Curves that moved with every frame would cost more than all else. */
  window() {
    const frames = this.model.frames;
    const length = Math.round(this.span * (this.model.fps || 0));
    if (!(length > 0) || length >= frames) return [0, Math.max(frames - 1, 1)];
    const first = Math.min(Math.floor(this.state.frame / length) * length, frames - 1 - length);
    return [first, first + length];
  }

  draw() {
    if (this.parent.hidden || this.plots.length === 0) return;
    if (this.window()[0] !== this.drawnFrom) this.drawCurves();
    else this.drawCursors();
  }

  drawCurves() {
    if (this.parent.hidden || !this.plots) return;
    this.drawnFrom = this.window()[0];
    for (const plot of this.plots) this.drawPlot(plot);
    this.drawCursors();
  }

  drawPlot({canvas, lines, low, high}) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.round(canvas.clientWidth * ratio);
    const height = Math.round(canvas.clientHeight * ratio);
    if (width === 0) return;
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    const context = canvas.getContext('2d');
    context.clearRect(0, 0, width, height);
    const [first, last] = this.window();
    const y = value => height * (high - value) / (high - low);
    context.lineWidth = ratio;
    context.font = `${10 * ratio}px system-ui, sans-serif`;
    context.fillStyle = themeColour('--faint');
    context.strokeStyle = themeColour('--line');
    const step = niceStep((high - low) / 3);
    for (let value = Math.ceil(low / step) * step; value <= high; value += step) {
      context.beginPath();
      context.moveTo(0, y(value));
      context.lineTo(width, y(value));
      context.stroke();
      if (y(value) > 11 * ratio) context.fillText(`${Math.round(value)}°`, 2 * ratio, y(value) - 2 * ratio);
    }
    context.lineWidth = 1.6 * ratio;
    context.lineJoin = 'round';
    context.globalAlpha = (last - first) / width > 2 ? 0.6 : 1;
    for (const {side, values} of lines) {
      context.strokeStyle = SIDE_COLOURS[side] || themeColour('--middle');
      context.beginPath();
      this.traceCurve(context, values, first, last, width, y);
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  /** All values where a pixel has few; where it has many, their lowest and highest. */
  traceCurve(context, values, first, last, width, y) {
    const perPixel = (last - first) / width;
    if (perPixel <= 2) {
      let isDown = false;
      for (let t = Math.max(0, Math.floor(first)); t <= Math.min(last + 1, values.length - 1); ++t) {
        if (values[t] !== values[t]) {
          isDown = false;
          continue;
        }
        const x = (t - first) / (last - first) * width;
        if (isDown) context.lineTo(x, y(values[t]));
        else context.moveTo(x, y(values[t]));
        isDown = true;
      }
      return;
    }
    let isDown = false;
    for (let x = 0; x < width; ++x) {
      let [low, high] = [Infinity, -Infinity];
      const end = Math.min(first + (x + 1) * perPixel, values.length - 1);
      for (let t = Math.floor(first + x * perPixel); t <= end; ++t) {
        if (values[t] < low) low = values[t];
        if (values[t] > high) high = values[t];
      }
      if (low > high) {
        isDown = false;
        continue;
      }
      if (isDown) context.lineTo(x, y(high));
      else context.moveTo(x, y(high));
      context.lineTo(x, y(low));
      isDown = true;
    }
  }

  drawCursors() {
    const [first, last] = this.window();
    const frame = Math.min(this.state.frame, this.model.frames - 1);
    const share = (frame - first) / (last - first);
    for (const {cursor, now, lines, unit} of this.plots) {
      cursor.style.left = `${100 * share}%`;
      now.textContent = '';
      for (const {side, values} of lines) {
        const span = document.createElement('span');
        const value = values[frame];
        const text = Number.isFinite(value) ? `${Math.round(value)}${unit === 'deg' ? '°' : ` ${unit}`}` : '–';
        span.textContent = side === 'm' ? text : `${side === 'l' ? 'L' : 'R'} ${text}`;
        span.className = `side-${side}`;
        now.append(span);
      }
    }
  }
}

function niceStep(rough) {
  const power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].map(k => k * power).find(step => step >= rough) || rough;
}
