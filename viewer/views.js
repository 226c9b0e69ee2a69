// What each camera saw: the keypoints found there, the solution as it looks from there, and how far they are apart.
import {offColour, sideColour, themeColour} from './colours.js';
import {asAdultCm} from './model.js';

const SIDES = ['l', 'm', 'r'];

/** Of a tile: the image's, but neither narrow nor flat, so that tiles stay small. */
function aspectOf(camera) {
  const [w, h] = camera.size;
  return w > 0 && h > 0 ? Math.min(Math.max(w / h, 1), 16 / 9) : 16 / 9;
}

/** The smallest region of a tile's shape around this one: x, y, width, height. */
function widen([x, y, width, height], aspect) {
  const [w, h] = [Math.max(width, height * aspect), Math.max(height, width / aspect)];
  return [x - (w - width) / 2, y - (h - height) / 2, w, h];
}

/** The part of the image that people are in, with some room; all of it where nobody is. */
function cropOf(camera) {
  let [left, top, right, bottom] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const detections of camera.detections) {
    if (!detections) continue;
    const {keypoints} = detections;
    const step = 2 * Math.max(1, Math.floor(keypoints.length / 20000));
    for (let i = 0; i + 1 < keypoints.length; i += step) {
      if (keypoints[i] !== keypoints[i]) continue;
      left = Math.min(left, keypoints[i]);
      right = Math.max(right, keypoints[i]);
      top = Math.min(top, keypoints[i + 1]);
      bottom = Math.max(bottom, keypoints[i + 1]);
    }
  }
  const [w, h] = camera.size;
  const whole = widen([0, 0, w, h], aspectOf(camera));
  if (!(left < right)) return whole;
  const room = 0.08 * Math.max(right - left, bottom - top);
  const crop = widen([left - room, top - room, right - left + 2 * room, bottom - top + 2 * room], aspectOf(camera));
  return crop[2] < whole[2] ? crop : whole;
}

export class Views {
  constructor(parent, state, actions) {
    this.parent = parent;
    this.state = state;
    this.actions = actions;
  }

  setModels(models) {
    this.models = models;
    this.build();
  }

  get model() { return this.models[this.state.active]; }

  build() {
    this.parent.textContent = '';
    if (this.models.length > 1) this.parent.append(this.makeResultChoice());
    const tiles = document.createElement('div');
    tiles.className = 'tiles';
    this.tiles = this.model.cameras.map(camera => this.makeTile(camera, tiles));
    this.parent.append(tiles);
    if (this.model.cameras.length === 0) {
      tiles.append(note('This file has no cameras, only people.'));
    } else {
      this.parent.append(this.makeLegend());
    }
    this.observe();
  }

  makeResultChoice() {
    const choice = document.createElement('div');
    choice.className = 'segments';
    this.models.forEach((_, r) => {
      const button = document.createElement('button');
      button.textContent = `${'AB'[r] || r + 1} · ${this.state.resultNames[r]}`;
      button.setAttribute('aria-pressed', r === this.state.active);
      button.onclick = () => this.actions.activate(r);
      choice.append(button);
    });
    return choice;
  }

  makeTile(camera, parent) {
    const figure = document.createElement('figure');
    figure.className = 'tile';
    figure.dataset.camera = camera.name;
    const canvas = document.createElement('canvas');
    canvas.style.aspectRatio = String(aspectOf(camera));
    const caption = document.createElement('figcaption');
    const name = document.createElement('b');
    name.textContent = camera.name;
    const fit = document.createElement('span');
    fit.className = 'fit';
    caption.append(name, fit);
    figure.append(canvas, caption);
    const buttons = document.createElement('div');
    buttons.className = 'tile-buttons';
    const enlarge = document.createElement('button');
    enlarge.className = 'enlarge';
    enlarge.title = `Larger or smaller (${camera.index + 1})`;
    enlarge.setAttribute('aria-label', `${camera.name} larger`);
    enlarge.innerHTML = '<svg viewBox="0 0 24 24"><path d="M4 10V4h6M20 14v6h-6M4 4l7 7M20 20l-7-7" fill="none"/></svg>';
    enlarge.onclick = () => this.actions.selectCamera(camera.index);
    buttons.append(enlarge);
    if (camera.isKnown) {
      const through = document.createElement('button');
      through.className = 'through';
      through.title = 'Look through this camera in 3D';
      through.setAttribute('aria-label', `Look through ${camera.name}`);
      through.innerHTML = '<svg viewBox="0 0 24 24"><path d="M2 12s4-7 10-7 10 7 10 7-4 7-10 7S2 12 2 12z" fill="none"/><circle cx="12" cy="12" r="3"/></svg>';
      through.onclick = () => this.actions.lookThrough(camera.index);
      buttons.append(through);
    }
    figure.append(buttons);
    canvas.onclick = () => this.actions.selectCamera(camera.index);
    const isOff = this.model.isOff(camera);
    figure.classList.toggle('off', isOff);
    figure.classList.toggle('unused', !camera.used);
    if (!camera.used) {
      fit.textContent = camera.whyNot ? `not used: ${camera.whyNot}` : 'not used';
    } else if (Number.isFinite(camera.medianPercent)) {
      fit.textContent = `${isOff ? '▲ does not fit · ' : ''}${camera.medianPx.toFixed(1)} px ≈ ${asAdultCm(camera.medianPercent)}`;
      fit.title = 'How far the keypoints are from the solution, in the median over all frames; centimetres at the size of an adult';
    } else {
      fit.textContent = 'no keypoints in this file';
    }
    parent.append(figure);
    return {camera, figure, canvas, crop: cropOf(camera), whole: widen([0, 0, ...camera.size], aspectOf(camera))};
  }

  makeLegend() {
    const legend = document.createElement('p');
    legend.className = 'key';
    legend.innerHTML = `<span><i class="ring"></i> found in the image</span><span><i class="bar"></i> solution seen from there</span>
      <span>apart: <i class="ramp"></i> <small>as usual → far off</small></span>`;
    return legend;
  }

  observe() {
    if (this.observer) this.observer.disconnect();
    this.observer = new ResizeObserver(() => this.draw());
    this.tiles.forEach(tile => this.observer.observe(tile.canvas));
  }

  draw() {
    if (!this.tiles || this.parent.hidden) return;
    for (const tile of this.tiles) {
      const {camera, figure, canvas} = tile;
      const isShown = this.state.cameras.has(camera.index);
      figure.hidden = !isShown;
      figure.classList.toggle('selected', this.state.selected === camera.index);
      figure.classList.toggle('seen-through', this.state.through === camera.index);
      if (isShown && canvas.clientWidth > 0) this.drawTile(tile);
    }
  }

  drawTile({camera, canvas, crop, whole}) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.round(canvas.clientWidth * ratio);
    const height = Math.round(canvas.clientHeight * ratio);
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    const context = canvas.getContext('2d');
    const [x0, y0, w] = this.state.layers.wholeImage ? whole : crop;
    const scale = width / w;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = themeColour('--image');
    context.fillRect(0, 0, width, height);
    if (!(camera.size[0] > 0)) return;
    context.strokeStyle = themeColour('--image-edge');
    context.lineWidth = ratio;
    context.strokeRect(-x0 * scale, -y0 * scale, camera.size[0] * scale, camera.size[1] * scale);
    context.lineCap = 'round';
    const frame = Math.min(this.state.frame, this.model.frames - 1);
    const calibration = camera.at(frame);
    for (const person of this.model.people) {
      if (!this.state.people.has(person.index)) continue;
      const seen = this.reproject(camera, calibration, person, frame);
      this.drawSolution(context, person, seen, x0, y0, scale, ratio);
      this.drawDetections(context, camera, calibration, person, seen, frame, x0, y0, scale, ratio);
    }
  }

  /** (J, 3): pixel and depth, NaN where unknown. */
  reproject(camera, calibration, person, frame) {
    const seen = new Float64Array(3 * person.joints.length).fill(NaN);
    if (!calibration) return seen;
    const point = [0, 0, 0];
    const pixel = [0, 0, 0];
    person.joints.forEach((name, j) => {
      if (!this.state.isJointShown(name) || !person.between(frame + camera.frameOffset, j, point)) return;
      if (camera.project(calibration, point, pixel)) seen.set(pixel, 3 * j);
    });
    return seen;
  }

  drawSolution(context, person, seen, x0, y0, scale, ratio) {
    context.lineWidth = 2.4 * ratio;
    context.globalAlpha = 0.85;
    for (const side of SIDES) {
      context.strokeStyle = sideColour(side);
      context.beginPath();
      person.joints.forEach((_, j) => {
        const p = person.parents[j];
        if (person.sides[j] !== side || p < 0 || seen[3 * j] !== seen[3 * j] || seen[3 * p] !== seen[3 * p]) return;
        context.moveTo((seen[3 * j] - x0) * scale, (seen[3 * j + 1] - y0) * scale);
        context.lineTo((seen[3 * p] - x0) * scale, (seen[3 * p + 1] - y0) * scale);
      });
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  drawDetections(context, camera, calibration, person, seen, frame, x0, y0, scale, ratio) {
    const detections = camera.detections[person.index];
    if (!detections || !this.state.layers.keypoints) return;
    const J = person.joints.length;
    person.joints.forEach((name, j) => {
      const confidence = detections.confidence[frame * J + j];
      const u = detections.keypoints[2 * (frame * J + j)];
      const v = detections.keypoints[2 * (frame * J + j) + 1];
      if (!this.state.isJointShown(name) || !(confidence > 0) || u !== u) return;
      const x = (u - x0) * scale;
      const y = (v - y0) * scale;
      let colour = offColour(0);
      if (seen[3 * j] === seen[3 * j]) {
        const px = Math.hypot(seen[3 * j] - u, seen[3 * j + 1] - v);
        const severity = this.model.severity(100 * px * seen[3 * j + 2] / (calibration.focal[0] * person.bones));
        colour = offColour(severity);
        context.strokeStyle = colour;
        context.lineWidth = (1.2 + 1.6 * severity) * ratio;
        context.beginPath();
        context.moveTo(x, y);
        context.lineTo((seen[3 * j] - x0) * scale, (seen[3 * j + 1] - y0) * scale);
        context.stroke();
      }
      context.strokeStyle = colour;
      context.fillStyle = colour;
      context.globalAlpha = 0.35 + 0.65 * Math.min(confidence, 1);
      context.lineWidth = 1.5 * ratio;
      context.beginPath();
      context.arc(x, y, 3 * ratio, 0, 7);
      context.stroke();
      context.globalAlpha = 1;
    });
  }
}

function note(text) {
  const p = document.createElement('p');
  p.className = 'note';
  p.textContent = text;
  return p;
}

export {note};
