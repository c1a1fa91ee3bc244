import {
  AmbientLight,
  Box3,
  DirectionalLight,
  HemisphereLight,
  OrthographicCamera,
  Vector3,
  type Object3D,
  type Scene,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { unit, VIEWS, type Vec3, type ViewName } from '../model';
import { projectionOf, type Projection } from './projection';

/** The camera with its light, and how the pointer turns it. */
export class CameraRig {
  readonly camera = new OrthographicCamera(-1, 1, 1, -1, 1, 4000);
  readonly controls: OrbitControls;
  private center = new Vector3(0, 0, 0);
  private radius_mm = 130;

  constructor(scene: Scene, canvas: HTMLCanvasElement) {
    const { camera } = this;
    camera.up.set(0, 0, 1);
    const sky = new HemisphereLight(0xffffff, 0x9aa4ae, 0.5);
    sky.position.set(0, 0, 1); // Superior is up.
    const headlight = new DirectionalLight(0xffffff, 2.1);
    headlight.position.set(-0.35, 0.45, 1);
    camera.add(headlight);
    scene.add(new AmbientLight(0xffffff, 0.55), sky, camera);
    this.controls = new OrbitControls(camera, canvas);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
  }

  look(name: ViewName): void {
    this.controls.target.copy(this.center);
    this.camera.position.copy(this.center).addScaledVector(new Vector3(...unit(VIEWS[name])), 1000);
    this.camera.lookAt(this.center);
    this.controls.update();
  }

  /** Centers the view on objects; returns false if there are none. */
  frame(objects: Iterable<Object3D>): boolean {
    const box = new Box3();
    for (const object of objects) box.expandByObject(object);
    if (box.isEmpty()) return false;
    const offset = this.camera.position.clone().sub(this.controls.target);
    box.getCenter(this.center);
    this.radius_mm = box.getSize(new Vector3()).length() / 2;
    this.controls.target.copy(this.center);
    this.camera.position.copy(this.center).add(offset);
    this.camera.zoom = 1;
    return true;
  }

  get aspect(): number {
    return this.camera.right / this.camera.top;
  }

  set aspect(aspect: number) {
    // Room for the head in both directions; a face seen from the side is about as wide as high.
    const half = this.radius_mm * 0.82 * Math.max(1, 1 / aspect);
    this.camera.top = half;
    this.camera.bottom = -half;
    this.camera.left = -half * aspect;
    this.camera.right = half * aspect;
    this.camera.updateProjectionMatrix();
  }

  /** The projection of a view `height_px` high whose middle is at `center_px`. */
  projection(height_px: number, center_px: [number, number]): Projection {
    const { camera } = this;
    const forward = camera.getWorldDirection(new Vector3());
    const up = new Vector3(0, 1, 0).applyQuaternion(camera.quaternion);
    const px_per_mm = (camera.zoom * height_px) / (camera.top - camera.bottom);
    return projectionOf(toArray(this.controls.target), toArray(forward), toArray(up), px_per_mm, center_px);
  }
}

const toArray = ({ x, y, z }: Vector3): Vec3 => [x, y, z];
