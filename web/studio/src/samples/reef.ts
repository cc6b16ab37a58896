// A jellyfish, a fish and a starfish: several pieces.
export const reef = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 820 680" width="820" height="680">
<g stroke="#5b2a63" stroke-width="9" stroke-linejoin="round" stroke-linecap="round">
<path fill="#d98fd0" d="M120 262c-4 60 24 100 8 158-10 34-36 62-22 100 6 16 26 14 28-2 4-36 30-60 38-98 12-58-8-104 0-158zm88 8c6 66-18 112-6 176 8 42 30 74 14 122-6 18 14 30 26 14 26-46-4-92-4-140 0-62 26-104 18-172zm96-8c10 60-10 98 2 152 10 40 40 62 44 104 2 18 24 18 28 0 10-44-24-74-34-112-12-52 6-94 4-148z"/>
<path fill="#b56bc4" d="M228 60c104 0 166 84 166 168 0 44-26 56-54 48-26-8-36-8-56 2-22 12-40 12-60 0-20-10-34-10-56 0-22 8-32 10-54-2-24 4-48-10-48-48C66 144 128 60 228 60z"/>
</g>
<g fill="#2b1030"><ellipse cx="186" cy="176" rx="13" ry="17"/><ellipse cx="274" cy="176" rx="13" ry="17"/></g>
<g fill="#fff"><circle cx="190" cy="170" r="4.5"/><circle cx="278" cy="170" r="4.5"/></g>
<path d="M206 208c14 14 34 14 48 0" fill="none" stroke="#2b1030" stroke-width="8" stroke-linecap="round"/>
<g fill="#f0b6e6"><circle cx="152" cy="206" r="14"/><circle cx="308" cy="206" r="14"/><circle cx="200" cy="102" r="12"/><circle cx="256" cy="92" r="8"/></g>
<g stroke="#9a4a12" stroke-width="9" stroke-linejoin="round">
<path fill="#f2a13c" d="M444 172c-8-40-2-70 12-84 10-8 30 4 58 36 30-34 76-52 122-52 70 0 122 44 138 96-16 52-68 96-138 96-46 0-92-18-122-52-28 32-48 44-58 36-14-14-20-36-12-76z"/>
</g>
<g fill="#fff6e6" stroke="#9a4a12" stroke-width="6"><path d="M574 86c-22 50-22 114 0 164l38 12c-26-56-26-132 0-188z"/></g>
<circle cx="700" cy="142" r="17" fill="#3b2110"/><circle cx="706" cy="136" r="6" fill="#fff"/>
<path d="M716 196c14 8 28 6 40-4" fill="none" stroke="#9a4a12" stroke-width="8" stroke-linecap="round"/>
<path d="M640 150c20 14 20 40 0 54" fill="none" stroke="#9a4a12" stroke-width="8" stroke-linecap="round"/>
<g stroke="#8c2f39" stroke-width="9" stroke-linejoin="round">
<path fill="#e8655f" d="M600 352c18-12 36-2 40 18l16 70 72 6c22 2 34 18 30 34-4 14-16 20-28 28l-52 38 14 72c4 22-8 36-24 36-14 0-24-10-32-18l-48-48-62 42c-18 12-36 6-42-10-4-14 2-26 8-38l32-64-56-48c-16-14-16-34-2-44 12-8 26-6 40-4l62 6 26-64c4-6 4-10 6-12z"/>
</g>
<g fill="#3b0f14"><ellipse cx="584" cy="500" rx="11" ry="14"/><ellipse cx="642" cy="502" rx="11" ry="14"/></g>
<path d="M596 534c10 12 24 12 34 0" fill="none" stroke="#3b0f14" stroke-width="7" stroke-linecap="round"/>
<g fill="#f7b3a6"><circle cx="612" cy="396" r="8"/><circle cx="614" cy="428" r="6"/><circle cx="712" cy="474" r="8"/><circle cx="684" cy="480" r="6"/><circle cx="676" cy="620" r="8"/><circle cx="662" cy="592" r="6"/><circle cx="514" cy="620" r="8"/><circle cx="532" cy="594" r="6"/><circle cx="498" cy="464" r="8"/><circle cx="528" cy="476" r="6"/></g>
</svg>`;
