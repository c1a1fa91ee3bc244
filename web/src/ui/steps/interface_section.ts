import { html, nothing } from 'lit-html';
import { withBoundary, type Boundary, type OuterBoundary, type Plan } from '../../model';
import { numberField } from '../number_field';
import { hint, section, segmented, select, toggle, type Html } from '../widgets';
import type { SetPlan } from './set_plan';

const DEFAULT_MARGIN_MM = 8;

const INTERFACES = [
  {
    value: 'clinical',
    text: 'Clinical',
    help: 'Tissue is bonded to bone, elevated near osteotomies, and slides at teeth and joints.',
  },
  {
    value: 'bonded',
    text: 'Bonded',
    help: 'Tissue on a mobilized segment moves with it. Tissue on stationary bone near the segment is free.',
  },
  { value: 'contact', text: 'Contact', help: 'A mobilized segment only pushes the tissue on it, without friction.' },
] as const;

const OUTER: { value: OuterBoundary; text: string }[] = [
  { value: 'roller', text: 'Roller: no displacement normal to the plane' },
  { value: 'foundation', text: 'Foundation: elastic tissue continues' },
  { value: 'free', text: 'Free' },
  { value: 'fixed', text: 'Fixed' },
];

/** What holds tissue to bone: options of the plan. */
export function interfaceSection({ boundary = {} }: Plan, set: SetPlan): Html {
  const kind = boundary.interface ?? 'clinical';
  const setBoundary = (part: Partial<Boundary>, gesture: string | null = null): void =>
    set({ boundary: withBoundary(boundary, part) }, gesture);
  return section(
    'Interface of tissue and bone',
    segmented('Interface of tissue and bone', INTERFACES, kind, (v) => setBoundary({ interface: v })),
    hint(INTERFACES.find((x) => x.value === kind)!.help),
    marginFields(boundary, kind === 'clinical', setBoundary),
    kind === 'clinical'
      ? numberField({
          label: 'Joint margin',
          hint: 'tissue this close to other bone that moves slides',
          value: boundary.joint_margin_mm ?? 8,
          unit: 'mm',
          min: 0,
          max: 100,
          step: 1,
          id: 'joint-margin',
          onInput: (v) => setBoundary({ joint_margin_mm: v }, 'joint-margin'),
        })
      : nothing,
    kind === 'clinical'
      ? numberField({
          label: 'Depth of the vestibule',
          hint: 'from the gingival margin to the fold; tissue on teeth and gingiva slides',
          value: boundary.vestibule_mm ?? 10,
          unit: 'mm',
          min: 0,
          max: 30,
          step: 1,
          id: 'vestibule',
          onInput: (v) => setBoundary({ vestibule_mm: v }, 'vestibule'),
        })
      : nothing,
    numberField({
      label: 'Interface layer',
      hint: 'thickness of the elastic layer below sliding tissue',
      value: boundary.interface_layer_mm ?? 1,
      unit: 'mm',
      min: 0.01,
      max: 100,
      step: 0.1,
      digits: 2,
      id: 'interface-layer',
      onInput: (v) => setBoundary({ interface_layer_mm: v }, 'interface-layer'),
    }),
    toggle('Separate the lips of a closed mouth', boundary.lips !== 'joined', (on) =>
      setBoundary({ lips: on ? undefined : 'joined' }),
    ),
  );
}

type SetBoundary = (part: Partial<Boundary>, gesture?: string | null) => void;

function marginFields({ elevation_margin_mm }: Boundary, isClinical: boolean, setBoundary: SetBoundary): Html {
  const isDefault = elevation_margin_mm === undefined;
  const help = isClinical
    ? 'tissue on bone this close to an osteotomy is elevated'
    : 'tissue on stationary bone this close to a segment is free';
  return html`${toggle(
    isClinical ? 'Elevation margins of the procedure' : `Default elevation margin (${DEFAULT_MARGIN_MM} mm)`,
    isDefault,
    (on) => setBoundary({ elevation_margin_mm: on ? undefined : DEFAULT_MARGIN_MM }),
  )}
  ${isDefault
    ? hint(`Elevation margin: ${help}.`)
    : numberField({
        label: 'Elevation margin',
        hint: help,
        value: elevation_margin_mm,
        unit: 'mm',
        min: 0,
        max: 100,
        step: 1,
        id: 'elevation-margin',
        onInput: (v) => setBoundary({ elevation_margin_mm: v }, 'elevation-margin'),
      })}`;
}

/** What the planes do in which the mesh ends. */
export function outerSection({ boundary = {} }: Plan, set: SetPlan): Html {
  const { scan_boundary = 'roller', cut_boundary = 'roller' } = boundary;
  const setBoundary: SetBoundary = (part, gesture = null) => set({ boundary: withBoundary(boundary, part) }, gesture);
  const of = (value: string): OuterBoundary | undefined => OUTER.find((x) => x.value === value)?.value;
  return section(
    'Ends of the mesh',
    select('Where the scan ends', OUTER, scan_boundary, (v) => setBoundary({ scan_boundary: of(v) })),
    select('Where the meshed region ends', OUTER, cut_boundary, (v) => setBoundary({ cut_boundary: of(v) })),
    hint('Tissue continues beyond these planes: free is too soft, fixed is too stiff.'),
    scan_boundary === 'foundation' || cut_boundary === 'foundation'
      ? numberField({
          label: 'Foundation thickness',
          hint: 'thickness of the tissue beyond the plane',
          value: boundary.foundation_mm ?? 20,
          unit: 'mm',
          min: 0.1,
          max: 1000,
          step: 1,
          id: 'foundation',
          onInput: (v) => setBoundary({ foundation_mm: v }, 'foundation'),
        })
      : nothing,
  );
}
