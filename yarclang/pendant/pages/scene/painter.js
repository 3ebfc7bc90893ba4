// Canvas, lights and floor. A frame is drawn only after a change, with fewer pixels on slow devices.

import { Color, DirectionalLight, GridHelper, HemisphereLight, Scene, Vector3, WebGLRenderer } from "/bundles/three.js";
import { Eye } from "/scene/eye.js";

const RATIOS = [1, 0.75, 0.5]; // shares of the screen's resolution, for devices that draw slowly
const MOST_RATIO = 2;
const SLOW = 60; // time between two frames above which drawing counts as slow [ms]
const HELD = 100; // shortest time between two frames while a button is held, so that its release isn't delayed [ms]
const STILL = 350; // time without a change after which the scene is drawn once at full resolution [ms]

export class Painter {
  // `element` receives the canvas. `hooks` are functions: `isHeld` (is a button held that moves the robot?), `before`
  // and `after` a frame, and `say` (show a message). Throws an error if the browser has no WebGL.
  constructor(element, hooks) {
    Object.assign(this, { element, hooks, frames: 0, slow: 0, level: 0, last: 0, told: null, grid: null });
    this.renderer = new WebGLRenderer({ antialias: true, powerPreference: "low-power" });
    this.renderer.debug.checkShaderErrors = false; // checking for errors would wait for the graphics card
    this.canvas = this.renderer.domElement;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "The robot in three dimensions");
    element.append(this.canvas);
    this.scene = new Scene();
    this.sky = new HemisphereLight(0xffffff, 0x8a8f98, 1.7);
    this.sky.position.set(0, 0, 1);
    this.sun = new DirectionalLight(0xffffff, 1.9);
    this.scene.add(this.sky, this.sun, this.sun.target);
    this.eye = new Eye(this.canvas, () => this.invalidate());
    this.floor = true;
    this.ending = new AbortController();
    this.listen();
    this.paint();
  }

  listen() {
    const { signal } = this.ending;
    this.canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      this.hooks.say("This browser has lost its graphics: the picture returns when they are restored.");
    }, { signal });
    this.canvas.addEventListener("webglcontextrestored", () => {
      this.hooks.say("");
      this.invalidate();
    }, { signal });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.paint(), { signal });
    this.themes = new MutationObserver(() => this.paint());
    this.themes.observe(document.documentElement, { attributes: true, attributeFilter: ["data-theme"] });
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(this.element);
  }

  // Prepare to draw another scene, described by `told`. Its shaders are compiled before the first frame.
  async take(told) {
    const first = !this.told;
    const other = first || JSON.stringify([told.low, told.high]) !== JSON.stringify([this.told.low, this.told.high]);
    this.told = told;
    if (first) this.resize();
    if (first || (other && !this.eye.touched)) this.eye.take(this.eye.view, told);
    if (other) this.paint();
    if (first) await this.renderer.compileAsync(this.scene, this.eye.camera).catch(() => {});
  }

  // Use the page's colours: light or dark.
  paint() {
    const styles = getComputedStyle(document.documentElement);
    const shade = (name) => new Color(styles.getPropertyValue(name).trim() || "#888");
    this.scene.background = shade("--ground");
    this.sky.intensity = this.scene.background.getHSL({}).l > 0.5 ? 1.9 : 1.35;
    if (this.told) {
      this.dropGrid();
      const far = Math.max(...this.told.low.map(Math.abs), ...this.told.high.map(Math.abs), 1);
      const wide = 2 * Math.ceil(1.25 * far);
      this.grid = new GridHelper(wide, Math.min(wide * 2, 60), shade("--line").lerp(shade("--soft"), 0.35), shade("--line"));
      this.grid.rotation.x = Math.PI / 2;
      this.grid.position.z = Math.min(this.told.low[2], 0) - 0.002;
      this.showFloor(this.floor);
      this.scene.add(this.grid);
    }
    this.invalidate();
  }

  showFloor(on) {
    this.floor = on;
    if (this.grid) this.grid.visible = on;
  }

  dropGrid() {
    this.grid?.removeFromParent();
    this.grid?.dispose();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!width || !height) return;
    this.eye.resize(width, height);
    this.scale();
    this.invalidate();
  }

  scale() {
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, MOST_RATIO) * (this.sharp ? 1 : RATIOS[this.level]));
    this.renderer.setSize(this.element.clientWidth, this.element.clientHeight);
  }

  // Request a new frame after a change.
  invalidate() {
    if (this.closed || this.asked || !this.told) return;
    const wait = this.hooks.isHeld() ? HELD - (performance.now() - this.last) : 0;
    this.asked = true;
    clearTimeout(this.sharpening);
    const next = () => requestAnimationFrame(() => this.draw());
    if (wait > 0) this.waiting = setTimeout(next, wait);
    else next();
  }

  draw() {
    this.asked = false;
    if (this.closed || !this.told) return;
    this.measure();
    this.hooks.before();
    const { camera } = this.eye;
    this.sun.position.copy(camera.position).add(new Vector3(-0.4, 0.3, 1.2));
    this.sun.target.position.copy(this.eye.controls.target);
    this.renderer.render(this.scene, camera);
    this.hooks.after(camera, this.element.clientWidth, this.element.clientHeight);
    this.frames += 1;
    if (this.level > 0 && !this.sharp) this.sharpening = setTimeout(() => this.sharpen(), STILL);
  }

  // Reduce the resolution if successive frames take too long.
  measure() {
    const now = performance.now();
    const each = now - this.last;
    this.last = now;
    if (this.sharp) {
      this.sharp = false;
      this.scale();
    }
    if (each > 250 || this.hooks.isHeld()) return;
    this.slow = each > SLOW ? this.slow + 1 : Math.max(this.slow - 0.5, 0);
    if (this.slow > 6 && this.level < RATIOS.length - 1) {
      this.level += 1;
      this.slow = 0;
      this.scale();
    }
  }

  // Draw the unchanged scene once at full resolution.
  sharpen() {
    if (this.closed || this.asked || this.hooks.isHeld()) return;
    this.sharp = true;
    this.scale();
    this.renderer.render(this.scene, this.eye.camera);
  }

  close() {
    this.closed = true;
    this.ending.abort();
    clearTimeout(this.waiting);
    clearTimeout(this.sharpening);
    this.themes.disconnect();
    this.sizes.disconnect();
    this.dropGrid();
    this.eye.close();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.canvas.remove();
  }
}
