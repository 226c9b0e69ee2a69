// The page: its state, what changes it, and who draws it.
import {forgetTheme, sideColour} from './colours.js';
import {readData} from './data.js';
import {Model} from './model.js';
import {Plots} from './plots.js';
import {Report} from './report.js';
import {Show} from './show.js';
import {SPEEDS, Timeline} from './timeline.js';
import {Views} from './views.js';
import {World} from './world.js';

const find = id => document.getElementById(id);

const state = {
  frame: 0,
  isPlaying: false,
  speed: 1,
  scene: 0,
  active: 0,       // the result whose views, angles and switches are shown
  selected: null,  // the camera that is shown large
  through: null,   // the camera that 3D is seen through
  people: new Set(),
  cameras: new Set(),
  hiddenJoints: new Set(),
  trailSeconds: 3,
  layers: {keypoints: true, uncertainty: false, limbTrails: false, cameras: true, floor: true, wholeImage: false, overlay: false},
  resultNames: [],
  isJointShown: joint => !state.hiddenJoints.has(joint),
  trailFrames: () => Math.min(Math.round(state.trailSeconds * (models[0].fps || 25)), models[0].frames),
};

let data;
let models = [];
const parts = {};
const frameTimes = [];  // when the last frames were drawn while playing, in milliseconds

const actions = {
  seek(frame) {
    state.frame = Math.min(Math.max(Math.round(frame), 0), models[0].frames - 1);
    playFrom();
    draw();
  },
  step(frames) {
    state.isPlaying = false;
    actions.seek(state.frame + frames);
  },
  togglePlay() {
    state.isPlaying = !state.isPlaying;
    if (state.isPlaying && state.frame >= models[0].frames - 1) state.frame = 0;
    frameTimes.length = 0;
    playFrom();
    draw();
  },
  setSpeed(speed) {
    state.speed = speed;
    playFrom();
    draw();
  },
  selectCamera(c) {
    state.selected = state.selected === c ? null : c;
    draw();
    const tile = document.querySelector('.tile.selected');
    if (tile) tile.scrollIntoView({block: 'nearest'});
  },
  lookThrough(c) {
    if (state.through === c) parts.world.leaveCamera();
    else parts.world.lookThrough(c);
    draw();
  },
  activate(r) {
    state.active = r;
    [parts.views, parts.plots, parts.show, parts.timeline].forEach(part => part.setModels(models));
    draw();
  },
  changed() { draw(); },
};

function draw() {
  parts.world.update();
  parts.world.draw();
  parts.timeline.draw();
  parts.views.draw();
  parts.plots.draw();
}

// ---- Time ----

let playedFrom = {clock: 0, seconds: 0};
function playFrom() {
  playedFrom = {clock: performance.now(), seconds: models[0].time(state.frame) ?? state.frame / 25};
}

function tick(clock) {
  if (state.isPlaying) {
    const seconds = playedFrom.seconds + (clock - playedFrom.clock) / 1000 * state.speed;
    const model = models[0];
    const hasTime = model.time(0) !== null;
    let frame = Math.max(0, Math.floor((hasTime ? model.frameAt(seconds) : seconds * 25) + 1e-6));
    if (frame >= model.frames) {
      frame = 0;
      state.frame = 0;
      playFrom();
    }
    if (frame !== state.frame) {
      state.frame = frame;
      draw();
      frameTimes.push(clock);
      if (frameTimes.length > 240) frameTimes.shift();
    } else {
      parts.world.draw();
    }
  } else {
    parts.world.draw();
  }
  requestAnimationFrame(tick);
}

// ---- Building the page ----

function setScene(s) {
  state.scene = s;
  const name = data.results[0].scenes[s].name;
  models = data.results.map(result => {
    const json = result.scenes.find(scene => scene.name === name) || result.scenes[Math.min(s, result.scenes.length - 1)];
    return new Model(data, json);
  });
  state.frame = 0;
  state.isPlaying = false;
  state.active = Math.min(state.active, models.length - 1);
  state.selected = null;
  state.through = null;
  const most = Math.max(...models.map(model => model.people.length));
  state.people = new Set(Array.from({length: most}, (_, p) => p));
  state.cameras = new Set(Array.from({length: Math.max(...models.map(model => model.cameras.length))}, (_, c) => c));
  parts.world.setModels(models);
  [parts.views, parts.plots, parts.show, parts.timeline].forEach(part => part.setModels(models));
  parts.report.set(data.results, models, data.program);
  buildNotes();
  playFrom();
  draw();
}

function buildNotes() {
  const {display, unit} = models[0];
  const notes = [];
  if (display.upIsGuess) notes.push(['Up is a guess', 'The file does not say where up is. It is taken from the cameras, which people hold about level.']);
  if (unit !== 'mm') notes.push(['Size unknown', 'Cameras alone cannot see how large somebody is. People are shown as large as adults; a square of the floor is then a metre.']);
  else notes.push(['1 square = 1 m', '']);
  find('notes').replaceChildren(...notes.map(([text, title]) => {
    const note = document.createElement('span');
    note.textContent = text;
    note.title = title;
    return note;
  }));
}

function buildViews() {
  const views = [['Overview', () => parts.world.overview()], ['Front', () => parts.world.lookAtPerson('front')],
                 ['Side', () => parts.world.lookAtPerson('side')], ['Top', () => parts.world.lookAtPerson('top')]];
  find('views').replaceChildren(...views.map(([name, look]) => {
    const button = document.createElement('button');
    button.textContent = name;
    button.onclick = () => {
      look();
      draw();
    };
    return button;
  }));
  find('legend').innerHTML = `<span style="--own:${sideColour('l')}">left</span><span style="--own:${sideColour('r')}">right</span>`;
}

const TABS = [['cameras', 'Cameras'], ['angles', 'Angles'], ['report', 'Report'], ['show', 'Show']];
function buildTabs() {
  const select = id => {
    for (const [other] of TABS) {
      find(`tab-${other}`).hidden = other !== id;
      find(`tab-button-${other}`).setAttribute('aria-selected', other === id);
    }
    find('panel').scrollTop = 0;
    draw();
    parts.plots.drawCurves();
  };
  find('tabs').replaceChildren(...TABS.map(([id, label]) => {
    const button = document.createElement('button');
    button.id = `tab-button-${id}`;
    button.role = 'tab';
    button.textContent = label;
    button.setAttribute('aria-controls', `tab-${id}`);
    button.setAttribute('aria-selected', id === 'cameras');
    button.onclick = () => select(id);
    return button;
  }));
  return select;
}

function buildTheme() {
  const button = find('theme');
  const isDark = () => (document.documentElement.dataset.theme || (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light')) === 'dark';
  const repaint = () => {
    forgetTheme();
    parts.world.paint();
    parts.timeline.drawStrips();
    draw();
    parts.plots.drawCurves();
  };
  button.onclick = () => {
    document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
    repaint();
  };
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', repaint);
}

const KEYS = [
  ['space', 'play or pause'], ['← →', 'one frame; with shift ten'], ['home end', 'first, last frame'], ['↑ ↓', 'faster, slower'],
  ['1 – 9', 'a camera larger'], ['v', 'look through the camera that is larger'], ['0', 'overview'], ['f s t', 'from the front, the side, the top'],
  ['u', 'uncertainty'], ['c', 'cameras'], ['k', 'keypoints'], ['?', 'this list'],
];

function toggleLayer(key) {
  state.layers[key] = !state.layers[key];
  parts.show.build();
  draw();
}

function buildKeys(selectTab) {
  const help = find('help');
  help.innerHTML = `<h2>Keys</h2><dl>${KEYS.map(([key, text]) => `<dt>${key.split(' ').map(k => `<kbd>${k}</kbd>`).join(' ')}</dt><dd>${text}</dd>`).join('')}</dl>
    <p class="small">Drag to turn the view, with two fingers or the right button to move it; wheel or pinch to zoom.</p>
    <form method="dialog"><button>Close</button></form>`;
  help.onclick = event => { if (event.target === help) help.close(); };
  find('help-button').onclick = () => help.showModal();
  const speed = by => SPEEDS[Math.min(Math.max(SPEEDS.indexOf(state.speed) + by, 0), SPEEDS.length - 1)];
  const keys = {
    ' ': () => actions.togglePlay(),
    ArrowLeft: event => actions.step(event.shiftKey ? -10 : -1),
    ArrowRight: event => actions.step(event.shiftKey ? 10 : 1),
    Home: () => actions.seek(0),
    End: () => actions.seek(models[0].frames - 1),
    ArrowUp: () => actions.setSpeed(speed(1)),
    ArrowDown: () => actions.setSpeed(speed(-1)),
    0: () => { parts.world.overview(); draw(); },
    f: () => { parts.world.lookAtPerson('front'); draw(); },
    s: () => { parts.world.lookAtPerson('side'); draw(); },
    t: () => { parts.world.lookAtPerson('top'); draw(); },
    v: () => { if (state.selected !== null) actions.lookThrough(state.selected); },
    u: () => toggleLayer('uncertainty'),
    c: () => toggleLayer('cameras'),
    k: () => toggleLayer('keypoints'),
    '?': () => help.showModal(),
  };
  document.addEventListener('keydown', event => {
    if (event.ctrlKey || event.metaKey || event.altKey || help.open) return;
    const isControl = /^(SELECT|TEXTAREA)$/.test(event.target.tagName) || (event.target.tagName === 'INPUT' && event.target.type !== 'range' && event.key === ' ');
    if (isControl) return;
    if (/^[1-9]$/.test(event.key)) {
      const c = Number(event.key) - 1;
      if (c < models[state.active].cameras.length) {
        selectTab('cameras');
        actions.selectCamera(c);
      }
    } else if (keys[event.key]) {
      keys[event.key](event);
    } else {
      return;
    }
    if (event.target.tagName === 'BUTTON' && event.key === ' ') event.target.blur();
    event.preventDefault();
  });
}

function buildHeader() {
  state.resultNames = data.results.map(result => result.name);
  find('files').textContent = state.resultNames.length > 1 ? state.resultNames.map((name, r) => `${'AB'[r] || r + 1} · ${name}`).join('   ') : state.resultNames[0];
  const scenes = data.results[0].scenes;
  const select = find('scene');
  scenes.forEach((scene, s) => select.add(new Option(scene.name, s)));
  find('scene-choice').hidden = scenes.length < 2;
  select.onchange = () => setScene(Number(select.value));
}

/** What the address says after #, such as #frame=46&tab=report: scene, frame, tab, camera, theme, layers (to switch). */
function obeyAddress(selectTab) {
  const wanted = new URLSearchParams(location.hash.slice(1));
  const number = key => (wanted.has(key) && Number.isFinite(Number(wanted.get(key))) ? Number(wanted.get(key)) : null);
  if (['light', 'dark'].includes(wanted.get('theme'))) {
    document.documentElement.dataset.theme = wanted.get('theme');
    forgetTheme();
    parts.world.paint();
    parts.timeline.drawStrips();
  }
  const scene = number('scene');
  if (scene !== null && data.results[0].scenes[scene]) {
    find('scene').value = scene;
    setScene(scene);
  }
  for (const key of (wanted.get('layers') || '').split(',')) {
    if (key in state.layers) toggleLayer(key);
  }
  if (TABS.some(([id]) => id === wanted.get('tab'))) selectTab(wanted.get('tab'));
  const camera = models[0].cameras.findIndex(c => c.name === wanted.get('camera'));
  if (camera >= 0) actions.selectCamera(camera);
  if (number('frame') !== null) actions.seek(number('frame'));
}

async function open() {
  data = await readData();
  buildHeader();
  buildViews();
  parts.world = new World(find('canvas'), find('labels'), state, () => draw());
  parts.timeline = new Timeline(state, actions);
  parts.views = new Views(find('tab-cameras'), state, actions);
  parts.plots = new Plots(find('tab-angles'), state, data, actions);
  parts.report = new Report(find('tab-report'), state);
  parts.show = new Show(find('tab-show'), state, actions);
  const selectTab = buildTabs();
  buildTheme();
  buildKeys(selectTab);
  setScene(0);
  if (!models[0].cameras.length) selectTab(models[0].people.some(p => p.series.length) ? 'angles' : 'report');
  obeyAddress(selectTab);
  find('wait').remove();
  requestAnimationFrame(tick);
  window.canonpose.isOpen = true;
  window.canonpose.openedAfterMilliseconds = performance.now();
}

// For tests and for people with a console.
window.canonpose = {
  isOpen: false,
  state,
  actions,
  get models() { return models; },
  /** [x, y, z] of each joint as the scene graph has it, in the coordinates of the file's world; null where it is not shown. */
  jointPositions: (person = 0, result = 0) => parts.world.jointPositions(result, person),
  /** Different frames drawn a second, over the last ones while playing. */
  framesPerSecond: () => (frameTimes.length < 2 ? 0 : 1000 * (frameTimes.length - 1) / (frameTimes[frameTimes.length - 1] - frameTimes[0])),
};

open().catch(error => {
  const wait = find('wait');
  if (wait) {
    wait.textContent = `This page could not be opened: ${error.message}.`;
    wait.className = 'failed';
  }
  throw error;
});
