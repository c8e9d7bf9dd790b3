// SPDX-License-Identifier: Apache-2.0
import * as three from "three";

/** Something to draw with, with a graphics card or without one; nothing where a browser draws no 3D at all. */
export function makeRenderer(): three.WebGLRenderer | undefined {
  try {
    return new three.WebGLRenderer({ alpha: true });
  } catch {
    return undefined;
  }
}

/** A picture that was drawn before, with its depth, so that what is drawn next may stand behind it. */
export function keptPicture(kept: three.WebGLRenderTarget): three.Mesh {
  const material = new three.ShaderMaterial({
    uniforms: { colour: { value: kept.texture }, depth: { value: kept.depthTexture } },
    vertexShader: "varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }",
    fragmentShader: `uniform sampler2D colour; uniform sampler2D depth; varying vec2 at;
      void main() { gl_FragColor = texture2D(colour, at); gl_FragDepth = texture2D(depth, at).r;
      #include <colorspace_fragment>
      }`,
    depthFunc: three.AlwaysDepth,
  });
  const sheet = new three.Mesh(new three.PlaneGeometry(2, 2), material);
  sheet.frustumCulled = false;
  sheet.renderOrder = -1;
  return sheet;
}
