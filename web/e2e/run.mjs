// Tests of the planner in a browser. node e2e/run.mjs [--all] [--only WORDS]; LEFORT names the program.
import { runTests } from './harness.mjs';
import './planning_tests.mjs';
import { all, endShared, only } from './shared_case.mjs';
import './solve_tests.mjs';

const good = await runTests({ all, only });
await endShared();
process.exit(good ? 0 : 1);
