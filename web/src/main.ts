import './ui/style.css';
import { startPlanner } from './ui';

// After the first picture: what draws in 3D takes its time to begin.
requestAnimationFrame(() => setTimeout(() => startPlanner(document.getElementById('app')!)));
