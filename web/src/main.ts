import './ui/style/index.css';
import { startPlanner } from './ui';

// After the first paint: the 3D view takes time to start.
requestAnimationFrame(() => setTimeout(() => startPlanner(document.getElementById('app')!)));
