// What is shown: people, cameras, joints, and layers.
import {personColour} from './colours.js';

const LAYERS = [
  ['keypoints', 'Keypoints found in the images'],
  ['uncertainty', 'Uncertainty, as spheres of two standard deviations'],
  ['limbTrails', 'Trails of hands and feet'],
  ['cameras', 'Cameras in 3D'],
  ['floor', 'Floor'],
  ['wholeImage', 'Whole images, not only where people are'],
  ['overlay', 'Results in one another instead of side by side'],
];
const TRAILS = [['none', 0], ['1 s', 1], ['3 s', 3], ['all', Infinity]];

export class Show {
  constructor(parent, state, actions) {
    this.parent = parent;
    this.state = state;
    this.actions = actions;
  }

  setModels(models) {
    this.models = models;
    this.build();
  }

  build() {
    this.parent.textContent = '';
    const model = this.models[this.state.active];
    const layers = this.section('Layers');
    for (const [key, label] of LAYERS) {
      if (key === 'overlay' && this.models.length < 2) continue;
      if (key === 'uncertainty' && !this.models.some(m => m.hasDeviations)) continue;
      if (key === 'keypoints' && !this.models.some(m => m.hasDetections)) continue;
      layers.append(this.check(label, this.state.layers[key], on => { this.state.layers[key] = on; }));
    }
    const trails = document.createElement('label');
    trails.className = 'line';
    trails.append('Path on the floor, last ');
    const select = document.createElement('select');
    TRAILS.forEach(([label, seconds]) => select.add(new Option(label, seconds, false, seconds === this.state.trailSeconds)));
    select.onchange = () => {
      this.state.trailSeconds = Number(select.value);
      this.actions.changed();
    };
    trails.append(select);
    layers.append(trails);

    const people = this.section('People');
    model.people.forEach(person => {
      const line = this.check(person.name, this.state.people.has(person.index), on => toggle(this.state.people, person.index, on));
      line.style.setProperty('--own', personColour(person.index));
      line.classList.add('swatch');
      people.append(line);
    });

    if (model.cameras.length > 0) {
      const cameras = this.section('Cameras');
      model.cameras.forEach(camera => cameras.append(
          this.check(camera.name + (camera.used ? '' : ' (not used)'), this.state.cameras.has(camera.index),
                     on => toggle(this.state.cameras, camera.index, on))));
    }
    this.buildJoints(model);
  }

  buildJoints(model) {
    const section = this.section('Joints');
    const groups = new Map();
    for (const person of model.people) {
      person.joints.forEach((joint, j) => {
        const group = person.groups[j];
        if (!groups.has(group)) groups.set(group, new Map());
        groups.get(group).set(joint, person.sides[j]);
      });
    }
    for (const [group, joints] of [...groups].sort()) {
      const details = document.createElement('details');
      const summary = document.createElement('summary');
      const boxes = [];
      const whole = this.check(group, true, on => {
        for (const joint of joints.keys()) toggle(this.state.hiddenJoints, joint, !on);
        boxes.forEach(box => { box.checked = on; });
      });
      whole.onclick = event => event.stopPropagation();
      whole.querySelector('input').checked = [...joints.keys()].some(joint => this.state.isJointShown(joint));
      summary.append(whole);
      details.append(summary);
      for (const [joint, side] of joints) {
        const line = this.check(joint, this.state.isJointShown(joint), on => toggle(this.state.hiddenJoints, joint, !on));
        line.classList.add(`side-${side}`);
        boxes.push(line.querySelector('input'));
        details.append(line);
      }
      section.append(details);
    }
  }

  section(title) {
    const section = document.createElement('section');
    const heading = document.createElement('h2');
    heading.textContent = title;
    section.append(heading);
    this.parent.append(section);
    return section;
  }

  check(label, isOn, set) {
    const line = document.createElement('label');
    line.className = 'line';
    const box = document.createElement('input');
    box.type = 'checkbox';
    box.checked = isOn;
    box.onchange = () => {
      set(box.checked);
      this.actions.changed();
    };
    line.append(box, ` ${label}`);
    return line;
  }
}

function toggle(set, element, on) {
  if (on) set.add(element);
  else set.delete(element);
}
