import './ui/style.css';
import { startPlanner } from './ui';

startPlanner(document.getElementById('app')!);
