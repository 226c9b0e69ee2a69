// A scene as the page draws it: where joints are, and where cameras see them.

/** An adult's bones, all together: what percent of the body means in centimetres. */
export const ADULT_BONES_CM = 450;

function rotationOfQuaternion(x, y, z, w) {
  const n = Math.hypot(x, y, z, w) || 1;
  [x, y, z, w] = [x / n, y / n, z / n, w / n];
  return [
    1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
    2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
    2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)];
}

const GROUPS = [
  ['Head', /nose|eye|ear|head|neck|jaw|chin/i, 'm'],
  ['arm', /sho|elb|wri|hand|arm|clav|thumb|finger/i, 'side'],
  ['leg', /hip|kne|ank|foot|toe|heel|leg/i, 'side'],
];

function groupOf(joint, side) {
  for (const [name, pattern, kind] of GROUPS) {
    if (!pattern.test(joint)) continue;
    if (kind === 'm') return name;
    if (side !== 'm') return `${side === 'l' ? 'Left' : 'Right'} ${name}`;
  }
  return 'Trunk';
}

class Person {
  constructor(data, json, index) {
    this.index = index;
    this.name = json.name || `Person ${index + 1}`;
    this.joints = json.joints;
    this.parents = json.parents;
    this.root = json.root;
    this.sides = json.sides;
    this.bones = json.bones;
    this.groups = json.joints.map((joint, j) => groupOf(joint, json.sides[j]));
    this.positions = data.array(json.positions);
    this.confidence = data.array(json.confidence);
    this.deviations = data.array(json.deviations);
    this.series = json.series;
    this.contacts = json.contacts;
    this.head = ['headtop', 'head', 'nose', 'neck/nose']
        .map(name => json.joints.findIndex(joint => joint.toLowerCase() === name)).find(j => j >= 0);
  }

  /** Writes the position at a whole frame into `out`; false where it is unknown. */
  at(frame, joint, out) {
    const i = 3 * (frame * this.joints.length + joint);
    out[0] = this.positions[i];
    out[1] = this.positions[i + 1];
    out[2] = this.positions[i + 2];
    return out[0] === out[0];
  }

  /** The same between frames, on the line between them. */
  between(frame, joint, out) {
    const first = Math.floor(frame);
    const share = frame - first;
    const last = this.positions.length / (3 * this.joints.length) - 1;
    if (first < 0 || (share > 0 ? first + 1 : first) > last) return false;
    if (!this.at(first, joint, out)) return false;
    if (share === 0) return true;
    const next = [0, 0, 0];
    if (!this.at(first + 1, joint, next)) return false;
    for (let k = 0; k < 3; ++k) out[k] += share * (next[k] - out[k]);
    return true;
  }
}

class SceneCamera {
  constructor(data, json, index, fps) {
    this.index = index;
    this.name = json.name;
    this.size = json.size;
    this.used = json.used;
    this.whyNot = json.whyNot;
    this.medianPx = json.medianPx;
    this.medianPercent = json.medianPercent;
    this.frameOffset = (json.timeOffset || 0) * (fps || 0);
    this.differenceByFrame = data.array(json.differenceByFrame);
    this.differenceByJoint = json.differenceByJoint;
    this.detections = json.detections.map(
        d => d && {keypoints: data.array(d.keypoints), confidence: data.array(d.confidence)});
    const calibration = json.calibration;
    this.isKnown = !!calibration;
    if (!calibration) return;
    this.centre = calibration.centre;
    this.distortion = calibration.distortion;
    this.isStatic = Array.isArray(calibration.focal);
    if (this.isStatic) {
      this.still = {focal: calibration.focal, rotation: calibration.rotation, translation: calibration.translation};
    } else {
      this.focals = data.array(calibration.focal);
      this.quaternions = data.array(calibration.quaternion);
      this.positions = data.array(calibration.position);
    }
  }

  /** {focal, rotation, translation} of a frame: x_in_camera = rotation x_in_world + translation. Null where unknown. */
  at(frame) {
    if (!this.isKnown) return null;
    if (this.isStatic) return this.still;
    if (this.cachedFrame === frame) return this.cached;
    const q = this.quaternions.subarray(4 * frame, 4 * frame + 4);
    const p = this.positions.subarray(3 * frame, 3 * frame + 3);
    const R = rotationOfQuaternion(...q);
    this.cachedFrame = frame;
    this.cached = {
      focal: [this.focals[2 * frame], this.focals[2 * frame + 1]],
      rotation: R,
      translation: [0, 3, 6].map(i => -(R[i] * p[0] + R[i + 1] * p[1] + R[i + 2] * p[2])),
    };
    return Number.isFinite(q[0]) ? this.cached : (this.cached = null);
  }

  /** The camera's centre in the world. */
  position(frame) {
    const c = this.at(frame);
    return c && [0, 1, 2].map(k => -[0, 1, 2].reduce((sum, i) => sum + c.rotation[3 * i + k] * c.translation[i], 0));
  }

  /** Writes pixel x, pixel y and depth into `out`; false where the point is behind the camera. */
  project(calibration, point, out) {
    const R = calibration.rotation;
    const t = calibration.translation;
    const z = R[6] * point[0] + R[7] * point[1] + R[8] * point[2] + t[2];
    if (!(z > 0)) return false;
    const x = (R[0] * point[0] + R[1] * point[1] + R[2] * point[2] + t[0]) / z;
    const y = (R[3] * point[0] + R[4] * point[1] + R[5] * point[2] + t[1]) / z;
    const [k1, k2, p1, p2, k3] = this.distortion;
    const r2 = x * x + y * y;
    const radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const dx = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
    const dy = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
    out[0] = calibration.focal[0] * dx + this.centre[0];
    out[1] = calibration.focal[1] * dy + this.centre[1];
    out[2] = z;
    return true;
  }
}

function median(values) {
  const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
  return sorted.length === 0 ? NaN : sorted[sorted.length >> 1];
}

export class Model {
  constructor(data, json) {
    this.name = json.name;
    this.capture = json.capture;
    this.frames = json.frames;
    this.fps = json.fps;
    this.times = json.times;
    this.unit = json.unit;
    this.up = json.up;
    this.scale = json.scale;
    this.display = json.display;
    this.people = json.people.map((person, p) => new Person(data, person, p));
    this.cameras = json.cameras.map((camera, c) => new SceneCamera(data, camera, c, json.fps));
    // What is usual in this recording, in percent of the body: from where on a difference stands out.
    const usual = median(this.cameras.filter(c => c.used).map(c => c.medianPercent));
    this.usualPercent = Math.min(Math.max(Number.isFinite(usual) ? usual : 0.3, 0.15), 0.6);
    this.hasDetections = this.cameras.some(c => c.detections.some(d => d));
    this.hasDeviations = this.people.some(p => p.deviations);
  }

  /** 0 for a difference as usual, 1 for one that is far off. */
  severity(percent) {
    return Math.min(Math.max((percent / this.usualPercent - 1.5) / 4, 0), 1);
  }

  /** Whether a camera fits much worse than the others. */
  isOff(camera) {
    if (!camera.used || !Number.isFinite(camera.medianPercent)) return false;
    const others = median(this.cameras.filter(c => c !== camera && c.used).map(c => c.medianPercent));
    return Number.isFinite(others) && camera.medianPercent > Math.max(2.5 * others, 0.4);
  }

  /** The seconds of a frame since the first; null where nothing is known of time. */
  time(frame) {
    if (this.times.length > 0) return this.times[frame];
    return this.fps > 0 ? frame / this.fps : null;
  }

  frameAt(seconds) {
    if (this.times.length === 0) return seconds * this.fps;
    let low = 0;
    let high = this.frames - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= seconds) low = middle;
      else high = middle - 1;
    }
    return low;
  }
}

/** A length in words: percent of the body's bones, as an adult's centimetres. */
export function asAdultCm(percent) {
  const cm = percent * ADULT_BONES_CM / 100;
  return cm >= 10 ? `${Math.round(cm)} cm` : `${cm.toFixed(1)} cm`;
}
