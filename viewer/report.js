// What `solve` and `evaluate` say, in plain words.
import {SIDE_COLOURS} from './colours.js';
import {asAdultCm} from './model.js';

function element(tag, text, className) {
  const made = document.createElement(tag);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  return made;
}

function table(head, rows) {
  const made = element('table');
  const header = made.createTHead().insertRow();
  head.forEach(text => header.append(element('th', text)));
  const body = made.createTBody();
  for (const {cells, className} of rows) {
    const row = body.insertRow();
    if (className) row.className = className;
    cells.forEach(text => { row.insertCell().textContent = text; });
  }
  const scroller = element('div', undefined, 'scroller');
  scroller.append(made);
  return scroller;
}

const number = (value, digits, unit = '') => (Number.isFinite(value) ? `${value.toFixed(digits)}${unit}` : '–');

export class Report {
  constructor(parent, state) {
    this.parent = parent;
    this.state = state;
  }

  /** `results`: as the page has them; `models`: of the scene that is shown. */
  set(results, models, program) {
    this.parent.textContent = '';
    results.forEach((result, r) => {
      if (results.length > 1) this.parent.append(element('h2', `${'AB'[r] || r + 1} · ${result.name}`, 'of-result'));
      this.addVerdict(result, models[r]);
      this.addCameras(result, models[r]);
      this.addEvaluation(result.evaluation, models[r]);
      this.addFindings(result, models[r]);
      this.addWorld(models[r]);
    });
    const about = element('p', undefined, 'about');
    about.textContent = `Made by canonpose ${program}. Drawn with three.js (MIT licence, © the three.js authors). ` +
        'Everything is in this file; it asks for nothing from any network.';
    this.parent.append(about);
  }

  captureOf(result, model) {
    const captures = result.solve ? result.solve.captures : [];
    if (!model.capture) return captures.length === 1 ? captures[0] : null;
    return captures.find(c => c.name === model.capture) || null;
  }

  addVerdict(result, model) {
    const capture = this.captureOf(result, model);
    const off = model.cameras.filter(camera => model.isOff(camera));
    const unused = model.cameras.filter(camera => !camera.used);
    const box = element('section', undefined, 'verdict');
    const cameras = model.cameras.filter(c => c.used && Number.isFinite(c.medianPercent)).map(c => c.medianPercent).sort((a, b) => a - b);
    const middle = cameras.length > 0 ? cameras[cameras.length >> 1] : NaN;
    if (capture && capture.trust) {
      box.append(element('p', capture.trust, 'big'));
    } else if (Number.isFinite(middle)) {
      box.append(element('p', `The keypoints are about ${asAdultCm(middle)} from where the solution has them (for an adult, in the median).`, 'big'));
    } else {
      box.append(element('p', `${model.people.length === 1 ? 'One person' : `${model.people.length} people`} in ${model.frames} frames.`, 'big'));
    }
    if (!capture) box.append(element('p', 'How far the result can be trusted stands in the report of solve, which is not in this page (view --report).'));
    if (off.length > 0) {
      box.append(element('p', `${off.map(c => c.name).join(' and ')} ${off.length > 1 ? 'do' : 'does'} not fit the others: see the magenta lines in its view.`, 'warn'));
    } else if (cameras.length > 1 && unused.length === 0) {
      box.append(element('p', 'No camera stands out from the others.'));
    }
    if (capture && capture.failure) box.append(element('p', `Not solved: ${capture.failure}.`, 'warn'));
    box.classList.toggle('unknown', !capture);
    box.classList.toggle('doubtful', off.length > 0 || unused.length > 0 || (capture ? !/^Nothing speaks/.test(capture.trust || '') : false));
    this.parent.append(box);
  }

  addCameras(result, model) {
    if (model.cameras.length === 0) return;
    const capture = this.captureOf(result, model);
    const section = element('section');
    section.append(element('h3', 'Cameras'));
    const rows = model.cameras.map(camera => {
      const found = capture && (capture.cameras || []).find(c => c.name === camera.name);
      const at = camera.at(0);
      const focal = at ? at.focal[0] : NaN;
      const fit = camera.used ? (Number.isFinite(camera.medianPercent) ? asAdultCm(camera.medianPercent) : '–') : `not used${camera.whyNot ? `: ${camera.whyNot}` : ''}`;
      return {
        cells: [camera.name, fit, number(camera.medianPx, 1), number(focal, 0), found && found.used ? number(found.outlier_percent, 1, ' %') : '–'],
        className: model.isOff(camera) ? 'off' : camera.used ? '' : 'unused',
      };
    });
    section.append(table(['', 'off by', 'px', 'focal length, px', 'outliers'], rows));
    section.append(element('p', 'Off by: from a keypoint to where the solution has it, in the median over frames and joints; centimetres at the size of an adult.', 'small'));
    this.parent.append(section);
  }

  addEvaluation(evaluation, model) {
    if (!evaluation) return;
    const section = element('section');
    const isTriangulated = /^triangulated/.test(evaluation.reference || '');
    section.append(element('h3', isTriangulated ? 'Against the calibrated cameras' : 'Against the truth'));
    const n = evaluation.n_mpjpe_mm;
    const p = evaluation.p_mpjpe_mm;
    section.append(element('p', `On average a joint is ${number(n, 1)} mm from where ${isTriangulated ? 'a triangulation by the calibrated cameras has it' : 'it really is'}, once each pose has the right size (N-MPJPE), ` +
        `and ${number(p, 1)} mm if each pose is also turned to fit (PMPJPE). ${number(evaluation.pck150_percent, 1)} % of all joints are within 15 cm.`));
    const own = evaluation.reference_reprojection_error_px;
    if (own) section.append(element('p', `That triangulation is itself ${number(own.median, 1)} px from the keypoints (median): smaller differences mean nothing.`, 'small'));
    const here = (evaluation.per_sequence || {})[model.name];
    if (here && Object.keys(evaluation.per_sequence).length > 1) {
      section.append(element('p', `These are means over all sequences of the file. In this one: ${number(here.n_mpjpe_mm, 1)} mm and ${number(here.p_mpjpe_mm, 1)} mm.`));
    }
    const joints = Object.entries(evaluation.per_joint || {});
    if (joints.length > 0) section.append(this.makeBars(joints, model));
    const cameras = evaluation.cameras;
    if (cameras && Number.isFinite(cameras.relative_rotation_deg)) {
      section.append(element('p', `Cameras: turned by ${number(cameras.relative_rotation_deg, 2)}° against each other, focal lengths off by ${number(cameras.focal_percent, 1)} %.`));
    }
    for (const warning of evaluation.warnings || []) section.append(element('p', warning, 'warn'));
    this.parent.append(section);
  }

  makeBars(joints, model) {
    const sides = new Map();
    for (const person of model.people) person.joints.forEach((joint, j) => sides.set(joint, person.sides[j]));
    const largest = Math.max(...joints.map(([, errors]) => errors.n_mpjpe_mm || 0), 1);
    const list = element('div', undefined, 'bars');
    for (const [joint, errors] of joints) {
      const row = element('div', undefined, 'row');
      const bar = element('i');
      bar.style.width = `${100 * errors.n_mpjpe_mm / largest}%`;
      bar.style.background = SIDE_COLOURS[sides.get(joint)] || 'var(--middle)';
      const track = element('span', undefined, 'bar-track');
      track.append(bar);
      row.append(element('span', joint), track, element('span', number(errors.n_mpjpe_mm, 0, ' mm'), 'value'));
      list.append(row);
    }
    return list;
  }

  addFindings(result, model) {
    const capture = this.captureOf(result, model);
    if (!capture) return;
    const texts = [
      ...(capture.findings || []).map(finding => finding.text), ...(capture.warnings || []),
      ...(capture.unseen_joints && capture.unseen_joints.length > 0 ? [`No camera ever sees ${capture.unseen_joints.join(', ')}.`] : []),
      ...(capture.swaps_mended > 0 ? [`Left and right were exchanged in ${capture.swaps_mended} frames of cameras, and put right.`] : []),
      ...(capture.mirror ? [`Which way round depth is: ${capture.mirror} (${number(capture.mirror_sigma, 1)} standard errors).`] : []),
      ...(Number.isFinite(capture.frames_solved) ? [`${capture.frames_solved} of ${capture.frames} frames solved.`] : []),
    ];
    if (texts.length === 0) return;
    const section = element('section');
    section.append(element('h3', 'What solving found'));
    const list = element('ul');
    texts.forEach(text => list.append(element('li', text)));
    section.append(list);
    this.parent.append(section);
  }

  addWorld(model) {
    const section = element('section');
    section.append(element('h3', 'The world'));
    const list = element('dl');
    const add = (term, text) => list.append(element('dt', term), element('dd', text));
    add('Up', model.up || 'a guess: the mean of the cameras, which people hold about level');
    add('Floor', model.display.floorIsGuess ? 'a guess: just below the lowest joints' : 'at the height 0 of the file');
    add('Size', model.unit === 'mm' ? `millimetres${model.scale ? `, from ${model.scale}` : ''}` : 'unknown; shown as large as an adult');
    add('Frames', `${model.frames}${model.fps > 0 ? `, ${Number(model.fps.toFixed(3))} a second` : ''}`);
    section.append(list);
    this.parent.append(section);
  }
}
