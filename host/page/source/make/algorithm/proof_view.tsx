// The proof of an algorithm: the verdict, what it costs on the chip, and what each build has computed.
import type { AlgorithmCheck, Proof } from '../../wire/messages.js';
import { kernelsText, resultText, verdictText } from './proof_text.js';

interface Fact {
  what: string;
  found: string;
  limit: string;
  isGood: boolean | null; // null: it has no limit
}

function factsOf({ instructions, stack, flash_bytes: flash, forbidden, test }: Proof): Fact[] {
  const facts: Fact[] = [];
  if (instructions !== null) {
    const { worst, mean, limit, fits, error } = instructions;
    const found = worst === null ? (error ?? 'not measured') : `${worst} instructions a tick at worst, ${Math.round(mean ?? worst)} on average`;
    facts.push({ what: 'Cost', found, limit: `${limit} instructions`, isGood: fits });
  }
  if (stack !== null) {
    const found = stack.bytes === null ? 'not known' : `${stack.bytes} bytes at most, in ${stack.function}`;
    facts.push({ what: 'Stack', found, limit: `${stack.limit} bytes`, isGood: stack.fits });
  }
  if (flash !== null) facts.push({ what: 'Flash', found: `${flash} bytes`, limit: '', isGood: null });
  if (forbidden !== null) {
    const isGood = forbidden.length === 0;
    facts.push({ what: 'Code', found: isGood ? 'neither floating point nor heap nor variables of its own' : forbidden.join('; '), limit: '', isGood });
  }
  if (test !== null) facts.push({ what: 'Test', found: test.passed ? `${test.name} passed` : `${test.name}: ${test.error}`, limit: '', isGood: test.passed });
  return facts;
}

function Facts({ proof }: { proof: Proof }) {
  return (
    <div class="table-frame" tabIndex={0} role="group" aria-label="Cost on the chip">
      <table data-testid="proof-cost">
        <caption>On the chip (Cortex-M4), with default parameters</caption>
        <thead>
          <tr>
            <th scope="col">what</th>
            <th scope="col">found</th>
            <th scope="col">limit</th>
            <th scope="col">result</th>
          </tr>
        </thead>
        <tbody>
          {factsOf(proof).map(({ what, found, limit, isGood }) => (
            <tr key={what}>
              <th scope="row">{what}</th>
              <td class="text">{found}</td>
              <td>{limit}</td>
              <td class={isGood === null ? '' : isGood ? 'good' : 'bad'}>{isGood === null ? '' : isGood ? 'good' : 'bad'}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

function shortHash(hash: string | null): string {
  return hash?.slice(0, 12) ?? '';
}

function Builds({ proof }: { proof: Proof }) {
  return (
    <div class="table-frame" tabIndex={0} role="group" aria-label="Table of the proof">
      <table data-testid="proof-builds">
        <caption>
          {proof.cases} random cases of {proof.ticks} ticks, played by each build; algorithm {proof.id}, sources {proof.sources}
        </caption>
        <thead>
          <tr>
            <th scope="col">build</th>
            <th scope="col">result</th>
            <th scope="col">kernels</th>
            <th scope="col">ticks</th>
            <th scope="col">set-points</th>
            <th scope="col">servo</th>
          </tr>
        </thead>
        <tbody>
          {proof.builds.map((build) => (
            <tr key={`${build.build} ${build.kernels}`}>
              <th scope="row">{build.build}</th>
              <td class={`text ${build.result === 'equal' ? 'good' : build.result === 'reference' ? '' : 'bad'}`}>{resultText(build)}</td>
              <td>{kernelsText(build.kernels)}</td>
              <td class="number">{build.ticks}</td>
              <td title={build.setpoint_hash ?? ''}>
                <code>{shortHash(build.setpoint_hash)}</code>
              </td>
              <td title={build.servo_hash ?? ''}>
                <code>{shortHash(build.servo_hash)}</code>
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

// isOld: the source has changed since.
export function ProofView({ check, isOld }: { check: AlgorithmCheck; isOld: boolean }) {
  const { state, proof } = check;
  return (
    <section class="proof" aria-label="Proof">
      <p role="status" data-testid="algorithm-check" class={state === 'passed' ? 'good verdict' : state === 'failed' ? 'bad verdict' : ''}>
        {verdictText(check)}
      </p>
      {state === 'running' && <progress aria-label="Steps of the proof" max={Math.max(check.of, 1)} value={Math.max(check.done - 1, 0)} />}
      {state === 'running' && <p class="hint">The first time takes minutes: the core is compiled by each compiler. You can go on meanwhile.</p>}
      {state !== 'running' && isOld && <p class="hint">The source has changed since.</p>}
      {proof !== null && (
        <>
          <Facts proof={proof} />
          <Builds proof={proof} />
        </>
      )}
    </section>
  );
}
