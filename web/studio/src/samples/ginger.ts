// A gingerbread figure: one piece.
export const ginger = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 640 720" width="640" height="720">
<g stroke="#7a431c" stroke-width="10" stroke-linejoin="round">
<path fill="#c77d3f" d="M320 40c66 0 116 46 116 108 0 38-18 68-46 88 12 8 20 14 26 20 44-14 96-40 128-62 24-16 54-8 64 14 10 24-2 48-26 62-46 28-104 54-154 68-4 40-4 76 2 112 26 52 54 104 82 152 14 26 6 56-20 68-26 12-54 2-68-22-34-58-70-112-104-150-34 38-70 92-104 150-14 24-42 34-68 22-26-12-34-42-20-68 28-48 56-100 82-152 6-36 6-72 2-112-50-14-108-40-154-68-24-14-36-38-26-62 10-22 40-30 64-14 32 22 84 48 128 62 6-6 14-12 26-20-28-20-46-50-46-88C204 86 254 40 320 40z"/>
</g>
<g fill="none" stroke="#fff6e6" stroke-width="9" stroke-linecap="round">
<path d="M70 214c8 16 20 22 30 44M96 196c6 14 16 22 24 42M570 214c-8 16-20 22-30 44M544 196c-6 14-16 22-24 42"/>
<path d="M168 620c18-2 34 2 52 14M186 592c16-2 32 4 48 16M472 620c-18-2-34 2-52 14M454 592c-16-2-32 4-48 16"/>
<path d="M246 112c22-34 52-46 74-46s52 12 74 46"/>
<path d="M262 186c36 32 80 32 116 0"/>
</g>
<g fill="#3b2110"><ellipse cx="276" cy="140" rx="15" ry="19"/><ellipse cx="364" cy="140" rx="15" ry="19"/></g>
<g fill="#fff"><circle cx="281" cy="133" r="5"/><circle cx="369" cy="133" r="5"/></g>
<g fill="#e88f7c"><circle cx="238" cy="176" r="16"/><circle cx="402" cy="176" r="16"/></g>
<path fill="#b3322e" stroke="#7d1f1c" stroke-width="6" stroke-linejoin="round" d="M320 252c-24-16-52-22-66-14-10 8-10 34 0 42 14 8 42 2 66-14 24 16 52 22 66 14 10-8 10-34 0-42-14-8-42-2-66 14z"/>
<circle cx="320" cy="259" r="14" fill="#d9534b" stroke="#7d1f1c" stroke-width="6"/>
<g stroke="#1c5a4a" stroke-width="5"><circle cx="320" cy="330" r="17" fill="#2f8f74"/><circle cx="320" cy="394" r="17" fill="#2f8f74"/></g>
</svg>`;
