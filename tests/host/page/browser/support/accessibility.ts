// What axe-core finds in the page.
import axe from 'axe-core';
import type { Viewer } from './viewer.js';

// Problems that axe-core takes as serious or critical.
export async function seriousProblems(viewer: Viewer): Promise<string[]> {
  await viewer.page.evaluate(axe.source);
  const violations = await viewer.page.evaluate(async () => {
    const run = (window as unknown as { axe: typeof axe }).axe.run;
    return (await run()).violations;
  });
  return violations
    .filter(({ impact }) => impact === 'serious' || impact === 'critical')
    .map(({ id, nodes }) => `${id}: ${nodes.map((node) => `${node.target.join(' ')} ${node.failureSummary}`).join('; ')}`);
}
