import tseslint from 'typescript-eslint';

// A folder may import only the folders before it, each through its index.ts.
const order = ['api', 'model', 'workers', 'scene', 'ui'];
const above = (folder) => order.slice(order.indexOf(folder) + 1);

const boundary = (folder, libraries) => ({
  files: [`src/${folder}/**/*.ts`],
  rules: {
    'no-restricted-imports': [
      'error',
      {
        patterns: [
          {
            group: above(folder)
              .map((name) => `**/${name}/**`)
              .concat(above(folder).map((name) => `**/${name}`)),
            message: `${folder} may not import a later folder (${order.join(' <- ')}).`,
          },
          { group: ['../*/*', '!../*/index', '!../../*'], message: 'Import a folder through its index.ts.' },
          ...libraries.map((library) => ({
            group: [library, `${library}/*`],
            message: `${folder} may not import ${library}.`,
          })),
        ].filter((pattern) => pattern.group.length > 0),
      },
    ],
  },
});

export default tseslint.config(
  { ignores: ['dist/', 'node_modules/', 'src/api/types.gen.ts'] },
  ...tseslint.configs.recommended,
  boundary('api', ['three', 'lit-html']),
  boundary('model', ['three', 'lit-html']),
  boundary('workers', ['three', 'lit-html']),
  boundary('scene', ['lit-html']),
  boundary('ui', ['three']),
  {
    files: ['src/model/**/*.ts'],
    rules: {
      'no-restricted-globals': ['error', 'window', 'document', 'fetch', 'localStorage', 'sessionStorage', 'navigator'],
    },
  },
  {
    files: ['src/**/*.ts'],
    rules: { 'max-lines-per-function': ['error', 60] },
  },
  {
    rules: {
      eqeqeq: 'error',
      'max-len': ['error', 120],
      'max-lines': ['error', 500],
      'prefer-const': 'error',
      'no-var': 'error',
      '@typescript-eslint/no-unused-vars': ['error', { argsIgnorePattern: '^_' }],
    },
  },
);
