// The people and cameras in 3D.
import * as THREE from 'three';
import {OrbitControls} from 'three-examples/controls/OrbitControls.js';
import {offColour, personColour, sideColour, themeColour} from './colours.js';

// In displayed units, which are metres of an adult.
const LIMB_RADIUS = 0.026;
const JOINT_RADIUS = 0.036;
const HEAD_RADIUS = 0.095;
const FRUSTUM_DEPTH = 0.5;
const PATH_WIDTH = 0.07;
const SHADOW_RADIUS = 0.34;
const DEVIATIONS_SHOWN = 2;  // radii of the spheres of uncertainty, in standard deviations
const SIDES = ['l', 'r', 'm'];

const material = (options, colour) => {
  const made = new THREE.MeshLambertMaterial(options);
  made.color.set(colour);
  made.emissive = new THREE.Color(colour).multiplyScalar(0.18);
  return made;
};

/** Instances of one shape that are filled anew for every frame. */
class Instances {
  constructor(parent, geometry, made, capacity) {
    this.mesh = new THREE.InstancedMesh(geometry, made, Math.max(capacity, 1));
    this.mesh.frustumCulled = false;
    parent.add(this.mesh);
    this.begin();
  }

  begin() { this.used = 0; }

  add(matrix) { matrix.toArray(this.mesh.instanceMatrix.array, 16 * this.used++); }

  end() {
    this.mesh.count = this.used;
    this.mesh.visible = this.used > 0;
    this.mesh.instanceMatrix.needsUpdate = true;
  }
}

/** One result: its people, floor path and cameras, in the coordinates of its world under a group that displays them. */
class ResultView {
  constructor(model, geometries) {
    this.model = model;
    this.group = new THREE.Group();
    this.group.matrixAutoUpdate = false;
    const {rotation: R, origin: o, scale: s} = model.display;
    const shift = [0, 3, 6].map(i => -s * (R[i] * o[0] + R[i + 1] * o[1] + R[i + 2] * o[2]));
    this.group.matrix.set(s * R[0], s * R[1], s * R[2], shift[0], s * R[3], s * R[4], s * R[5], shift[1],
                          s * R[6], s * R[7], s * R[8], shift[2], 0, 0, 0, 1);
    this.group.updateMatrixWorld(true);
    this.worldPerMetre = 1 / s;
    this.floor = new THREE.Group();  // in displayed coordinates
    this.makePeople(geometries);
    this.makePaths();
    this.makeTrails();
    this.makeCameras();
    this.placeOfJoint = new Map();  // "person joint" -> [instances, index]
  }

  makePeople(geometries) {
    const capacity = this.model.people.reduce((sum, person) => sum + person.joints.length, 0);
    this.limbs = {};
    this.joints = {};
    this.clouds = {};
    for (const side of SIDES) {
      this.limbs[side] = new Instances(this.group, geometries.limb, material({}, sideColour(side)), capacity);
      this.joints[side] = new Instances(this.group, geometries.ball, material({}, sideColour(side)), capacity);
      this.clouds[side] = new Instances(
          this.group, geometries.ball, material({transparent: true, opacity: 0.3, depthWrite: false}, sideColour(side)),
          capacity);
    }
    this.heads = new Instances(this.group, geometries.head, material({}, sideColour('m')), this.model.people.length);
    const dark = new THREE.MeshBasicMaterial({color: 0, transparent: true, opacity: 0.1, depthWrite: false});
    this.shadows = new Instances(this.floor, geometries.disc, dark, this.model.people.length);
  }

  /** Where a person went, as a ribbon on the floor. */
  makePaths() {
    this.paths = this.model.people.map((person, p) => {
      const geometry = new THREE.BufferGeometry();
      const made = new THREE.MeshBasicMaterial(
          {color: personColour(p), transparent: true, opacity: 0.6, side: THREE.DoubleSide, depthWrite: false});
      const mesh = new THREE.Mesh(geometry, made);
      mesh.frustumCulled = false;
      this.floor.add(mesh);
      return mesh;
    });
  }

  /** Where hands and feet went, as lines through all frames of which a stretch is drawn. */
  makeTrails() {
    this.trails = [];
    this.model.people.forEach(person => {
      person.joints.forEach((name, j) => {
        const isEnd = !person.parents.includes(j) && person.sides[j] !== 'm';
        if (!isEnd || !/wri|hand|ank|foot|toe/i.test(name)) return;
        const line = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({color: sideColour(person.sides[j])}));
        line.frustumCulled = false;
        this.group.add(line);
        this.trails.push({line, person, joint: j, filled: false});
      });
    });
  }

  makeCameras() {
    this.cameras = this.model.cameras.map(camera => {
      if (!camera.isKnown) return null;
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(11 * 6), 3));
      const lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({color: 0x888888}));
      lines.frustumCulled = false;
      this.group.add(lines);
      const face = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial(
          {color: 0x888888, transparent: true, opacity: 0.12, side: THREE.DoubleSide, depthWrite: false}));
      face.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(18), 3));
      face.frustumCulled = false;
      this.group.add(face);
      return {lines, face};
    });
  }

  /** In displayed coordinates. */
  show(point) { return new THREE.Vector3(...point).applyMatrix4(this.group.matrix); }

  paint() {
    for (const side of SIDES) {
      for (const instances of [this.limbs[side], this.joints[side], this.clouds[side]]) {
        instances.mesh.material.color.set(sideColour(side));
        instances.mesh.material.emissive.set(sideColour(side)).multiplyScalar(0.18);
      }
    }
    this.heads.mesh.material.color.set(sideColour('m'));
    this.heads.mesh.material.emissive.set(sideColour('m')).multiplyScalar(0.18);
    this.model.cameras.forEach((camera, c) => {
      const shown = this.cameras[c];
      if (!shown) return;
      const colour = this.model.isOff(camera) ? offColour(1) : themeColour('--frustum');
      shown.lines.material.color.set(colour);
      shown.face.material.color.set(colour);
    });
  }

  setOpacity(opacity) {
    for (const instances of [...SIDES.flatMap(side => [this.limbs[side], this.joints[side]]), this.heads]) {
      instances.mesh.material.transparent = opacity < 1;
      instances.mesh.material.opacity = opacity;
    }
  }

  update(state) {
    this.updatePeople(state);
    this.updatePaths(state);
    this.updateTrails(state);
    this.updateCameras(state);
  }

  updatePeople(state) {
    const all = [...SIDES.flatMap(side => [this.limbs[side], this.joints[side], this.clouds[side]]), this.heads, this.shadows];
    all.forEach(instances => instances.begin());
    const m = this.worldPerMetre;
    const matrix = new THREE.Matrix4();
    const a = new THREE.Vector3();
    const b = new THREE.Vector3();
    const turn = new THREE.Quaternion();
    const scale = new THREE.Vector3();
    const along = new THREE.Vector3(0, 1, 0);
    const point = [0, 0, 0];
    this.placeOfJoint.clear();
    for (const person of this.model.people) {
      if (!state.people.has(person.index)) continue;
      const frame = Math.min(state.frame, this.model.frames - 1);
      person.joints.forEach((name, j) => {
        if (!state.isJointShown(name) || !person.at(frame, j, point)) return;
        a.fromArray(point);
        const side = person.sides[j];
        matrix.compose(a, turn.set(0, 0, 0, 1), scale.setScalar(JOINT_RADIUS * m));
        this.placeOfJoint.set(`${person.index} ${j}`, [this.joints[side], this.joints[side].used]);
        this.joints[side].add(matrix);
        if (j === person.head) {
          matrix.compose(a, turn, scale.setScalar(HEAD_RADIUS * m));
          this.heads.add(matrix);
        }
        if (state.layers.uncertainty && person.deviations) {
          const deviation = person.deviations[frame * person.joints.length + j];
          if (deviation > 0) {
            matrix.compose(a, turn, scale.setScalar(Math.max(DEVIATIONS_SHOWN * deviation, 1.1 * JOINT_RADIUS * m)));
            this.clouds[side].add(matrix);
          }
        }
        const parent = person.parents[j];
        if (parent < 0 || !state.isJointShown(person.joints[parent]) || !person.at(frame, parent, point)) return;
        b.fromArray(point).sub(a);
        const length = b.length();
        if (!(length > 0)) return;
        turn.setFromUnitVectors(along, b.multiplyScalar(1 / length));
        matrix.compose(a, turn, scale.set(LIMB_RADIUS * m, length, LIMB_RADIUS * m));
        this.limbs[side].add(matrix);
      });
      if (state.layers.floor && person.at(frame, person.root, point)) {
        const shown = this.show(point);
        matrix.makeScale(SHADOW_RADIUS, SHADOW_RADIUS, 1).setPosition(shown.x, shown.y, 0.004);
        this.shadows.add(matrix);
      }
    }
    all.forEach(instances => instances.end());
  }

  updatePaths(state) {
    this.paths.forEach((mesh, p) => {
      const person = this.model.people[p];
      mesh.visible = state.trailSeconds !== 0 && state.people.has(p);
      if (!mesh.visible) return;
      const frames = Math.min(state.trailFrames(), 2000);
      const last = Math.min(state.frame, this.model.frames - 1);
      const step = Math.max(1, Math.round(frames / 160));
      const middle = [];
      const point = [0, 0, 0];
      for (let t = Math.max(0, last - frames); t <= last; t += step) {
        if (person.at(t, person.root, point)) middle.push(this.show(point));
      }
      const vertices = [];
      for (let i = 0; i + 1 < middle.length; ++i) {
        const from = middle[Math.max(i - 1, 0)];
        const to = middle[Math.min(i + 2, middle.length - 1)];
        const length = Math.hypot(to.x - from.x, to.y - from.y) || 1;
        const across = [-(to.y - from.y) / length, (to.x - from.x) / length];
        const corner = (at, width) => [
          [at.x - across[0] * width, at.y - across[1] * width, 0.008], [at.x + across[0] * width, at.y + across[1] * width, 0.008]];
        const [a1, a2] = corner(middle[i], PATH_WIDTH / 2 * (0.15 + 0.85 * i / middle.length));
        const [b1, b2] = corner(middle[i + 1], PATH_WIDTH / 2 * (0.15 + 0.85 * (i + 1) / middle.length));
        vertices.push(...a1, ...a2, ...b1, ...b1, ...a2, ...b2);
      }
      let attribute = mesh.geometry.getAttribute('position');
      if (!attribute || attribute.array.length < vertices.length) {
        attribute = new THREE.BufferAttribute(new Float32Array(vertices.length + 600), 3);
        mesh.geometry.setAttribute('position', attribute);
      }
      attribute.array.set(vertices);
      attribute.needsUpdate = true;
      mesh.geometry.setDrawRange(0, vertices.length / 3);
    });
  }

  updateTrails(state) {
    for (const trail of this.trails) {
      const {line, person, joint} = trail;
      line.visible = state.trailSeconds !== 0 && state.layers.limbTrails && state.people.has(person.index) &&
          state.isJointShown(person.joints[joint]);
      if (!line.visible) continue;
      if (!trail.filled) this.fillTrail(trail);
      const last = Math.min(state.frame, this.model.frames - 1);
      const first = Math.max(0, last - state.trailFrames());
      line.geometry.setDrawRange(first, last - first + 1);
    }
  }

  fillTrail(trail) {
    const points = new Float32Array(3 * this.model.frames);
    const point = [0, 0, 0];
    const known = [0, 0, 0];
    for (let t = 0; t < this.model.frames; ++t) {
      if (trail.person.at(t, trail.joint, point)) known.splice(0, 3, ...point);
      points.set(known, 3 * t);
    }
    trail.line.geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
    trail.filled = true;
  }

  updateCameras(state) {
    this.model.cameras.forEach((camera, c) => {
      const shown = this.cameras[c];
      if (!shown) return;
      const frame = Math.min(state.frame, this.model.frames - 1);
      const calibration = camera.at(frame);
      const isVisible = state.layers.cameras && state.cameras.has(c) && !!calibration && state.through !== c;
      shown.lines.visible = isVisible;
      shown.face.visible = isVisible;
      if (!isVisible || shown.frame === frame || (camera.isStatic && shown.frame !== undefined)) return;
      shown.frame = frame;
      const depth = FRUSTUM_DEPTH * this.worldPerMetre;
      const inWorld = (x, y, z) => {
        const p = [x - calibration.translation[0], y - calibration.translation[1], z - calibration.translation[2]];
        return [0, 1, 2].map(k => [0, 1, 2].reduce((sum, i) => sum + calibration.rotation[3 * i + k] * p[i], 0));
      };
      const corner = (u, v) => inWorld((u - camera.centre[0]) / calibration.focal[0] * depth,
                                       (v - camera.centre[1]) / calibration.focal[1] * depth, depth);
      const [w, h] = camera.size;
      const centre = inWorld(0, 0, 0);
      const corners = [corner(0, 0), corner(w, 0), corner(w, h), corner(0, h)];
      // A triangle above the image says where up is.
      const mark = [corner(0.3 * w, -0.06 * h), corner(0.5 * w, -0.3 * h), corner(0.7 * w, -0.06 * h)];
      const segments = [
        ...corners.flatMap(p => [centre, p]), ...corners.flatMap((p, i) => [p, corners[(i + 1) % 4]]),
        ...mark.flatMap((p, i) => [p, mark[(i + 1) % 3]])];
      const lines = shown.lines.geometry.getAttribute('position');
      lines.array.set(segments.flat());
      lines.needsUpdate = true;
      const face = shown.face.geometry.getAttribute('position');
      face.array.set([corners[0], corners[1], corners[2], corners[0], corners[2], corners[3]].flat());
      face.needsUpdate = true;
    });
  }
}

export class World {
  constructor(canvas, labels, state, onChange) {
    this.canvas = canvas;
    this.labelParent = labels;
    this.state = state;
    this.onChange = onChange;
    const context = canvas.getContext('webgl2', {antialias: true, alpha: false, powerPreference: 'high-performance'});
    if (!context) throw new Error('this browser does not draw in 3D (WebGL 2 is off)');
    this.renderer = new THREE.WebGLRenderer({canvas, context});
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.autoClear = false;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(42, 1, 0.05, 400);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableKeys = false;
    this.controls.screenSpacePanning = true;
    this.controls.maxPolarAngle = 0.97 * Math.PI;
    this.controls.addEventListener('change', () => { this.dirty = true; });
    this.controls.addEventListener('start', () => this.leaveCamera());
    this.hemisphere = new THREE.HemisphereLight(0xffffff, 0x8a8f99, 0.62);
    this.hemisphere.position.set(0, 0, 1);
    this.scene.add(this.hemisphere);
    this.sun = new THREE.DirectionalLight(0xffffff, 0.5);
    this.scene.add(this.sun);
    const limb = new THREE.CylinderBufferGeometry(1, 1, 1, 10, 1, true);
    limb.translate(0, 0.5, 0);
    this.geometries = {
      limb,
      ball: new THREE.SphereBufferGeometry(1, 12, 8),
      head: new THREE.SphereBufferGeometry(1, 20, 14),
      disc: new THREE.CircleBufferGeometry(1, 28),
    };
    this.results = [];
    this.dirty = true;
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }

  /** Shows the models of the results, side by side or in one another. */
  setModels(models) {
    for (const result of this.results) this.scene.remove(result.group, result.floor);
    this.results = models.map(model => new ResultView(model, this.geometries));
    for (const result of this.results) this.scene.add(result.group, result.floor);
    this.findExtent();
    this.makeGrid();
    this.makeLabels();
    this.paint();
    this.resize();
    this.overview();
  }

  findExtent() {
    const box = new THREE.Box3();
    this.peopleBox = new THREE.Box3();
    const point = [0, 0, 0];
    for (const result of this.results) {
      const step = Math.max(1, Math.floor(result.model.frames / 60));
      for (const person of result.model.people) {
        for (let t = 0; t < result.model.frames; t += step) {
          person.joints.forEach((_, j) => { if (person.at(t, j, point)) this.peopleBox.expandByPoint(result.show(point)); });
        }
      }
      result.model.cameras.forEach(camera => {
        const position = camera.position(0);
        if (position && position.every(Number.isFinite)) box.expandByPoint(result.show(position));
      });
    }
    if (this.peopleBox.isEmpty()) this.peopleBox.setFromCenterAndSize(new THREE.Vector3(0, 0, 0.9), new THREE.Vector3(1, 1, 1.8));
    box.union(this.peopleBox);
    this.box = box;
  }

  makeGrid() {
    if (this.grid) this.scene.remove(this.grid);
    const reach = Math.max(...['x', 'y'].flatMap(k => [Math.abs(this.box.min[k]), Math.abs(this.box.max[k])]));
    const half = Math.min(Math.max(Math.ceil(reach) + 1, 3), 40);
    this.grid = new THREE.GridHelper(2 * half, 2 * half);
    this.grid.rotation.x = Math.PI / 2;
    this.grid.material.transparent = true;
    this.grid.material.depthWrite = false;
    this.scene.add(this.grid);
  }

  makeLabels() {
    this.labelParent.textContent = '';
    this.labels = [];
    this.results.forEach((result, r) => {
      const add = (text, kind, colour, place) => {
        const element = document.createElement('span');
        element.className = `label ${kind}`;
        element.textContent = text;
        if (colour) element.style.setProperty('--own', colour);
        this.labelParent.append(element);
        this.labels.push({element, result: r, place});
      };
      result.model.cameras.forEach((camera, c) => camera.isKnown && add(camera.name, 'camera', null, frame => {
        if (!this.state.layers.cameras || !this.state.cameras.has(c) || this.state.through === c) return null;
        return camera.position(frame);
      }));
      if (result.model.people.length > 1) {
        result.model.people.forEach((person, p) => add(person.name, 'person', personColour(p), frame => {
          const point = [0, 0, 0];
          const joint = person.head === undefined ? person.root : person.head;
          return this.state.people.has(p) && person.at(frame, joint, point) ? point : null;
        }));
      }
      if (this.results.length > 1) {
        const title = document.createElement('span');
        title.className = 'result-name';
        title.textContent = `${'AB'[r] || r + 1} · ${this.state.resultNames[r]}`;
        this.labelParent.append(title);
        result.title = title;
      }
    });
  }

  paint() {
    this.background = new THREE.Color(themeColour('--stage'));
    this.scene.background = null;
    const line = new THREE.Color(themeColour('--grid'));
    const axis = new THREE.Color(themeColour('--grid-axis'));
    const colours = this.grid.geometry.getAttribute('color');
    const divisions = colours.count / 4 - 1;
    for (let i = 0; i <= divisions; ++i) {
      for (let k = 0; k < 4; ++k) {
        const colour = i === divisions / 2 ? axis : line;
        colours.setXYZ(4 * i + k, colour.r, colour.g, colour.b);
      }
    }
    colours.needsUpdate = true;
    this.scene.fog = new THREE.Fog(this.background.getHex(), 10, 40);
    for (const result of this.results) result.paint();
    this.dirty = true;
  }

  resize() {
    const {clientWidth, clientHeight} = this.canvas.parentElement;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.width = clientWidth;
    this.height = clientHeight;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.dirty = true;
  }

  // ---- Where one looks from ----

  lookFrom(direction, box = this.peopleBox) {
    this.leaveCamera();
    const middle = box.getCenter(new THREE.Vector3());
    const radius = 0.5 * box.getSize(new THREE.Vector3()).length();
    const viewport = this.viewports()[0];
    this.camera.fov = 42;
    this.camera.aspect = viewport.width / viewport.height;
    const half = Math.atan(Math.tan(this.camera.fov * Math.PI / 360) * Math.min(1, this.camera.aspect));
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(direction.clone().normalize(), Math.max(radius / Math.sin(half), 2.2));
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.dirty = true;
  }

  /** People and cameras, from above the side where no camera hides them. */
  overview() {
    const box = this.box.clone();
    const middle = this.peopleBox.getCenter(new THREE.Vector3());
    // Cameras far away would make people small.
    const limit = 2.2 * Math.max(this.peopleBox.getSize(new THREE.Vector3()).length(), 2.5);
    box.min.clamp(middle.clone().addScalar(-limit), middle);
    box.max.clamp(middle, middle.clone().addScalar(limit));
    box.min.z = Math.max(box.min.z, -0.1);
    this.lookFrom(new THREE.Vector3(0.62, -1, 0.5), box);
    const toPeople = middle.sub(this.controls.target).multiplyScalar(0.5);
    this.controls.target.add(toPeople);
    this.camera.position.add(toPeople);
    this.camera.position.lerp(this.controls.target, 0.34);
    this.controls.update();
  }

  /** From in front of the first person as it now stands: 'front', 'side' (its left) or 'top'. */
  lookAtPerson(from) {
    if (from === 'top') return this.lookFrom(new THREE.Vector3(0, -0.001, 1));
    const result = this.results[0];
    const person = result.model.people.find(p => this.state.people.has(p.index)) || result.model.people[0];
    const pair = person.joints.findIndex((name, j) => person.sides[j] === 'l' && /hip/i.test(name));
    const partner = person.joints.findIndex((name, j) => person.sides[j] === 'r' && /hip/i.test(name));
    const left = [0, 0, 0];
    const right = [0, 0, 0];
    let across = new THREE.Vector3(0, 1, 0);
    const frame = Math.min(this.state.frame, result.model.frames - 1);
    if (pair >= 0 && partner >= 0 && person.at(frame, pair, left) && person.at(frame, partner, right)) {
      across = result.show(left).sub(result.show(right)).setZ(0).normalize();
    }
    const front = across.clone().cross(new THREE.Vector3(0, 0, 1));
    return this.lookFrom((from === 'side' ? across : front).add(new THREE.Vector3(0, 0, 0.12)));
  }

  /** Looks through a camera of the active result until the view is turned. */
  lookThrough(c) {
    this.state.through = c;
    this.dirty = true;
  }

  leaveCamera() {
    if (this.state.through === null) return;
    this.state.through = null;
    this.camera.up.set(0, 0, 1);
    const distance = this.camera.position.distanceTo(this.peopleBox.getCenter(new THREE.Vector3()));
    const ahead = this.camera.getWorldDirection(new THREE.Vector3());
    this.controls.target.copy(this.camera.position).addScaledVector(ahead, distance);
    this.camera.fov = 42;
    this.onChange();
    this.dirty = true;
  }

  placeInCamera(c, viewport) {
    const result = this.results[this.state.active] || this.results[0];
    const camera = result.model.cameras[c];
    const calibration = camera && camera.at(Math.min(this.state.frame, result.model.frames - 1));
    if (!calibration) return;
    const R = calibration.rotation;
    const turn = new THREE.Matrix4().set(R[0], -R[3], -R[6], 0, R[1], -R[4], -R[7], 0, R[2], -R[5], -R[8], 0, 0, 0, 0, 1);
    const display = new THREE.Matrix4().extractRotation(result.group.matrix);
    this.camera.quaternion.setFromRotationMatrix(display.multiply(turn));
    this.camera.position.copy(result.show(camera.position(Math.min(this.state.frame, result.model.frames - 1))));
    const [w, h] = camera.size;
    const fits = viewport.width / viewport.height > w / h;
    const tangent = fits ? h / (2 * calibration.focal[1]) : w / (2 * calibration.focal[0]) * viewport.height / viewport.width;
    this.camera.fov = 360 / Math.PI * Math.atan(tangent);
  }

  // ---- Drawing ----

  viewports() {
    const {width, height} = this;
    if (this.results.length < 2 || this.state.layers.overlay) return [{x: 0, y: 0, width, height, results: this.results}];
    const isWide = width >= height;
    return this.results.map((result, r) => {
      const share = 1 / this.results.length;
      return isWide ? {x: Math.round(r * share * width), y: 0, width: Math.round(share * width), height, results: [result]}
                    : {x: 0, y: Math.round(r * share * height), width, height: Math.round(share * height), results: [result]};
    });
  }

  /** What the state says; drawn with the next call of draw(). */
  update() {
    for (const result of this.results) result.update(this.state);
    if (this.grid) this.grid.visible = this.state.layers.floor;
    this.results.forEach((result, r) => result.setOpacity(this.state.layers.overlay && r > 0 ? 0.42 : 1));
    const viewports = this.viewports().length;
    if (this.shownViewports && this.shownViewports !== viewports) this.overview();
    this.shownViewports = viewports;
    this.dirty = true;
  }

  placeDivider(viewports) {
    if (!this.divider) {
      this.divider = document.createElement('i');
      this.divider.id = 'divider';
    }
    this.labelParent.append(this.divider);
    this.divider.hidden = viewports.length < 2;
    if (viewports.length < 2) return;
    const {x, y, width, height} = viewports[1];
    Object.assign(this.divider.style, x > 0 ? {left: `${x}px`, top: 0, width: '1px', height: `${height}px`}
                                            : {left: 0, top: `${y}px`, width: `${width}px`, height: '1px'});
  }

  draw() {
    if (!this.dirty || !this.width || this.results.length === 0) return;
    this.dirty = false;
    const {renderer} = this;
    renderer.setScissorTest(true);
    renderer.setClearColor(this.background);
    const viewports = this.viewports();
    this.placeDivider(viewports);
    for (const viewport of viewports) {
      this.camera.aspect = viewport.width / viewport.height;
      if (this.state.through !== null) this.placeInCamera(this.state.through, viewport);
      this.camera.updateProjectionMatrix();
      this.camera.updateMatrixWorld();
      this.sun.position.copy(this.camera.position).add(new THREE.Vector3(1, -1, 4));
      const distance = this.camera.position.distanceTo(this.controls.target);
      this.scene.fog.near = 1.6 * distance;
      this.scene.fog.far = 5 * distance + 6;
      for (const result of this.results) {
        result.group.visible = viewport.results.includes(result);
        result.floor.visible = result.group.visible;
      }
      const bottom = this.height - viewport.y - viewport.height;
      renderer.setViewport(viewport.x, bottom, viewport.width, viewport.height);
      renderer.setScissor(viewport.x, bottom, viewport.width, viewport.height);
      renderer.clear();
      renderer.render(this.scene, this.camera);
      this.placeLabels(viewport);
    }
  }

  placeLabels(viewport) {
    const point = new THREE.Vector3();
    for (const {element, result, place} of this.labels) {
      const view = this.results[result];
      if (!viewport.results.includes(view)) continue;
      const isDouble = this.state.layers.overlay && result > 0;
      const world = isDouble ? null : place(Math.min(this.state.frame, view.model.frames - 1));
      let isVisible = !!world && world.every(Number.isFinite);
      if (isVisible) {
        point.copy(view.show(world)).project(this.camera);
        isVisible = point.z < 1 && Math.abs(point.x) < 1 && Math.abs(point.y) < 1;
      }
      element.style.display = isVisible ? '' : 'none';
      if (!isVisible) continue;
      const x = viewport.x + (point.x + 1) / 2 * viewport.width;
      const y = viewport.y + (1 - point.y) / 2 * viewport.height;
      element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -160%)`;
    }
    for (const result of viewport.results) {
      if (!result.title) continue;
      result.title.style.left = `${viewport.x + 12}px`;
      result.title.style.maxWidth = `${viewport.width - 24}px`;
      const line = this.state.layers.overlay ? 20 * this.results.indexOf(result) : 0;
      result.title.style.top = `${viewport.y + (viewport.y === 0 ? 46 : 8) + line}px`;
    }
  }

  /** Where the scene graph has a person's joints, in the world's coordinates; null where one is not shown. */
  jointPositions(result, person) {
    const view = this.results[result];
    return view.model.people[person].joints.map((_, j) => {
      const place = view.placeOfJoint.get(`${person} ${j}`);
      if (!place) return null;
      const matrix = new THREE.Matrix4().fromArray(place[0].mesh.instanceMatrix.array, 16 * place[1]);
      const position = new THREE.Vector3().setFromMatrixPosition(matrix);
      return position.toArray();
    });
  }
}

